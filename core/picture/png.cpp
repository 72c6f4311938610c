#include "core/picture/png.h"

#include <fmt/format.h>
#include <png.h>

#include "core/base/error.h"
#include "core/io/file_io.h"

namespace sightline {

std::vector<uint8_t> encodePng(const Image& image) {
  if (image.width == 0 || image.height == 0 || image.pixels.size() != size_t(image.width) * image.height) {
    throw Error("the picture has no pixels or the wrong number of them");
  }
  png_image description = {};
  description.version = PNG_IMAGE_VERSION;
  description.width = image.width;
  description.height = image.height;
  description.format = PNG_FORMAT_RGB;
  static_assert(sizeof(Rgb) == 3);

  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(description);
  std::vector<uint8_t> bytes(size);
  if (png_image_write_to_memory(&description, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) == 0) {
    throw Error(fmt::format("cannot encode the picture: {}", description.message));
  }
  bytes.resize(size);
  return bytes;
}

void savePng(const Image& image, const std::filesystem::path& file) {
  OutputFile output(file);
  std::vector<uint8_t> bytes;
  try {
    bytes = encodePng(image);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", file.string(), error.what()));
  }
  output.write(bytes.data(), bytes.size());
  output.commit();
}

}  // namespace sightline

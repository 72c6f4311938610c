#include "core/report/png.h"

#include <fmt/format.h>
#include <png.h>

#include "core/error.h"
#include "core/scene/file_io.h"

namespace sightline {

void savePng(const Image& image, const std::filesystem::path& file) {
  if (image.width == 0 || image.height == 0 || image.pixels.size() != size_t(image.width) * image.height) {
    throw Error(fmt::format("{}: the picture has no pixels or the wrong number of them", file.string()));
  }
  png_image description = {};
  description.version = PNG_IMAGE_VERSION;
  description.width = image.width;
  description.height = image.height;
  description.format = PNG_FORMAT_RGB;
  static_assert(sizeof(Rgb) == 3);

  OutputFile output(file);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(description);
  std::vector<char> bytes(size);
  if (png_image_write_to_memory(&description, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) == 0) {
    throw Error(fmt::format("{}: cannot encode the picture: {}", file.string(), description.message));
  }
  output.write(bytes.data(), size);
  output.commit();
}

}  // namespace sightline

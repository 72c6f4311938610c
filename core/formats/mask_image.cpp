#include "core/formats/mask_image.h"

#include <fmt/format.h>
#include <png.h>

#include "core/base/error.h"

namespace sightline {

std::vector<uint8_t> maskImage(const Surfaces& surfaces, uint32_t mask) {
  const uvec4 size = surfaces.masks[mask].size_wrap_first;
  const size_t texels = size_t(size.x) * size.y;
  std::vector<uint8_t> grey_alpha(2 * texels, 255);
  for (size_t i = 0; i < texels; ++i) {
    const bool holds = ((surfaces.texels[size.w + i / 32] >> (i % 32)) & 1u) != 0;
    grey_alpha[2 * i + 1] = holds ? 255 : 0;
  }
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = size.x;
  image.height = size.y;
  image.format = PNG_FORMAT_GA;
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<uint8_t> png(bytes);
  if (png_image_write_to_memory(&image, png.data(), &bytes, 0, grey_alpha.data(), 0, nullptr) == 0) {
    throw Error(fmt::format("cannot encode the image of a mask: {}", image.message));
  }
  png.resize(bytes);
  return png;
}

}  // namespace sightline

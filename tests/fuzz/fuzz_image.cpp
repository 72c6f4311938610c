#include <span>

#include "core/base/error.h"
#include "core/formats/alpha_image.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    const sightline::AlphaImage image = sightline::readAlphaImage(std::span(data, size), "image");
    const uint64_t texels = uint64_t(image.width) * image.height;
    if (texels == 0 || (!image.alpha.empty() && image.alpha.size() != texels)) __builtin_trap();
  } catch (const sightline::Error&) {
  }
  return 0;
}

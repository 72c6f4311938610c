#include "core/picture/mark_pixels.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/picture/cell_overlay.h"

namespace sightline {
namespace {

constexpr Rgb kRingColor{200, 0, 60};
constexpr size_t kMaxRings = 200;   ///< more missing pixels than that are found without help
constexpr double kRingRadius = 10;  ///< pixels

struct Pixel {
  double x = 0, y = 0;
};

}  // namespace

void markMissing(Image& image, std::span<const size_t> pixels) {
  if (pixels.size() <= kMaxRings) {
    std::vector<Pixel> centers;
    for (const size_t pixel : pixels) {
      const double x = double(pixel % image.width), y = double(pixel / image.width);
      const auto near = [&](const Pixel& center) {
        return std::hypot(center.x - x, center.y - y) < kRingRadius * 0.7;
      };
      if (std::none_of(centers.begin(), centers.end(), near)) centers.push_back({x, y});
    }
    for (const Pixel& center : centers) {
      drawRing(image, center.x + 0.5, center.y + 0.5, kRingRadius, 2, kRingColor);
    }
  }
  for (const size_t pixel : pixels) image.pixels[pixel] = kMissingColor;
}

}  // namespace sightline

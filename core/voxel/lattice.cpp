#include "core/voxel/lattice.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.h"

namespace sightline {
namespace {

bool fits(const Lattice& lattice, const Bounds& bounds) {
  const glm::dvec3 low = glm::floor(lattice.toVoxels(bounds.low)),
                   high = glm::floor(lattice.toVoxels(bounds.high));
  for (int axis = 0; axis < 3; ++axis) {
    // A closed cube also touches the plane below it: one voxel more at the lower end.
    if (high[axis] - low[axis] + 2 > double(kMostVoxelsAlong)) return false;
    if (low[axis] - 1 < -double(kLargestVoxelPlace) || high[axis] >= double(kLargestVoxelPlace)) return false;
  }
  return true;
}

// Of the power of two, with all digits: fewer would not be one.
std::string sizeText(int exponent) {
  return fmt::format("{}", std::ldexp(1.0, exponent));
}

}  // namespace

Lattice latticeOf(double voxel_size) {
  int exponent = 0;
  const double mantissa = std::isfinite(voxel_size) && voxel_size > 0 ? std::frexp(voxel_size, &exponent) : 0;
  if (mantissa == 0.5 && exponent > -100 && exponent < 100) return {exponent - 1};
  if (mantissa == 0 || exponent <= -100 || exponent >= 100) {
    throw Error(
        fmt::format("a voxel of {:g} is too small or too large: expected a power of two such as 0.25 or 0.5",
                    voxel_size),
        kExitUsage);
  }
  throw Error(fmt::format("a voxel of {:g} is not a power of two: take {} or {}", voxel_size,
                          sizeText(exponent - 1), sizeText(exponent)),
              kExitUsage);
}

Lattice latticeFor(const Bounds& bounds, uint64_t along) {
  const glm::dvec3 size = glm::dvec3(bounds.high) - glm::dvec3(bounds.low);
  const double longest = std::max({size.x, size.y, size.z, 0x1p-80});
  int exponent = 0;
  std::frexp(longest / double(along), &exponent);  // 2^(exponent - 1) <= quotient < 2^exponent
  if (std::ldexp(double(along), exponent - 1) >= longest) --exponent;
  return {exponent};
}

void requireFits(const Lattice& lattice, const Bounds& bounds) {
  if (fits(lattice, bounds)) return;
  Lattice larger = lattice;
  while (!fits(larger, bounds)) ++larger.exponent;
  throw Error(
      fmt::format(
          "voxels of {} are too small for this scene, which may hold {} of them along an axis and reach "
          "{} from the origin: take {} or more",
          sizeText(lattice.exponent), kMostVoxelsAlong, kLargestVoxelPlace, sizeText(larger.exponent)),
      kExitUsage);
}

}  // namespace sightline

#include "core/generate/leaf_mask.h"

#include "core/scene/masked_triangle.h"

namespace sightline {
namespace {

/// Between two arcs (parabolas) from root to root + (x, y).
struct Leaf {
  int root_x, root_y, x, y;  ///< texels
};

constexpr int kStem = 32, kStemTop = 14, kStemHalf = 1;
constexpr Leaf kLeaves[] = {{32, 60, -25, -15}, {32, 60, 25, -15},  {32, 46, -25, -16},
                            {32, 46, 25, -16},  {32, 32, -21, -17}, {32, 32, 21, -17},
                            {32, 20, -13, -15}, {32, 20, 13, -15},  {32, 22, 0, -21}};
/// Half of a leaf's width in its middle, of its length: 1 / kSlender.
constexpr int64_t kSlender = 4;

/// In whole numbers: along runs from 0 to length^2, and a leaf's half width is 4 s (1 - s) / kSlender of the
/// length at the share s.
bool isIn(const Leaf& leaf, int x, int y) {
  const int64_t dx = x - leaf.root_x, dy = y - leaf.root_y;
  const int64_t length2 = int64_t(leaf.x) * leaf.x + int64_t(leaf.y) * leaf.y;
  const int64_t along = dx * leaf.x + dy * leaf.y, across = dx * leaf.y - dy * leaf.x;
  if (along < 0 || along > length2) return false;
  return kSlender * (across < 0 ? -across : across) * length2 <= 4 * along * (length2 - along);
}

}  // namespace

void addLeafMask(Surfaces& surfaces) {
  addMask(surfaces, kLeafTexels, kLeafTexels, {kWrapClamp, kWrapClamp}, [](uint64_t texel) {
    const int x = int(texel % kLeafTexels), y = int(texel / kLeafTexels);
    if (x >= kStem - kStemHalf && x < kStem + kStemHalf && y >= kStemTop) return true;
    for (const Leaf& leaf : kLeaves) {
      if (isIn(leaf, x, y)) return true;
    }
    return false;
  });
}

}  // namespace sightline

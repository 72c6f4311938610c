#pragma once
#include <glm/glm.hpp>

namespace sightline {

/// Voxels from a low to a high one, both with their ends; none where low > high along an axis.
struct VoxelBox {
  glm::ivec3 low{0}, high{-1};
};

inline VoxelBox overlapOf(const VoxelBox& a, const VoxelBox& b) {
  return {glm::max(a.low, b.low), glm::min(a.high, b.high)};
}

}  // namespace sightline

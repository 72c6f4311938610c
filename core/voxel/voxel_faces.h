#pragma once
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/scene/scene.h"
#include "core/voxel/voxel_grid.h"

namespace sightline {

/// A rectangle of sides of voxels that are in a set, where the voxels beyond are not.
struct VoxelFace {
  glm::ivec3 low{0};   ///< its lowest corner, in voxels
  glm::ivec2 size{1};  ///< along the two axes that it does not cross, ascending
  int axis = 0;        ///< that it crosses
  bool high = false;   ///< faces up that axis, else down

  /// Counterclockwise seen from outside of the set.
  std::array<glm::ivec3, 4> corners() const;
};

/// Whether faces side by side are made one.
enum class FaceMerging {
  kNone,   ///< each is the side of one voxel: along each edge as many faces run one way as the other
  kBlocks  ///< rectangles within a block, as large as they get row by row: fewer, but corners of some lie on
           ///< edges of others
};

/// The faces between a set and all else, each side of a voxel in one of them, in the order of the blocks.
/// Same result on any number of threads.
std::vector<VoxelFace> facesOf(const VoxelGrid& grid, FaceMerging merging);

/// Faces with shared corners.
struct VoxelMesh {
  std::vector<glm::vec3> positions;  ///< the scene's space: exact; ascending in z, y, x
  std::vector<glm::uvec4> faces;     ///< corners, counterclockwise from outside
};

/// Throws Error for an empty set, and one whose corners floats do not hold: farther than 2^24 voxels from the
/// origin.
VoxelMesh voxelMesh(const VoxelGrid& grid, FaceMerging merging);

/// Two triangles a face, 2 i and 2 i + 1 of face i; one object, "voxels". Throws as voxelMesh, and for 2^31
/// faces or more.
Scene voxelScene(const VoxelGrid& grid, FaceMerging merging);

}  // namespace sightline

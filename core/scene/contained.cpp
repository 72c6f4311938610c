#include "core/scene/contained.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/scene/box_triangle.h"
#include "core/scene/cell_frame.h"
#include "core/scene/triangle_area.h"

namespace sightline {
namespace {

/// Triangles of one task; the result does not depend on it.
constexpr size_t kBlock = 1 << 15;

/// How far, along each local axis, the corners of the faces in float lie from those of the exact box.
glm::dvec3 roundingOfFaces(const ViewCell& cell, const CellFrame& frame) {
  glm::dvec3 margin(0.0);
  for (const Face& face : cellFaces(cell)) {
    for (const glm::vec4& corner : {face.corner, face.corner + face.edge_u, face.corner + face.edge_v,
                                    face.corner + face.edge_u + face.edge_v}) {
      const glm::dvec3 local = frame.toLocal(glm::dvec3(corner));
      margin = glm::max(margin, glm::abs(glm::abs(local) - frame.half_size));
    }
  }
  return margin;
}

}  // namespace

std::vector<uint32_t> containedTriangles(const Scene& scene, const ViewCell& cell) {
  const CellFrame frame = cellFrame(cell);
  const glm::dvec3 margin = roundingOfFaces(cell, frame);
  const glm::dvec3 half_size = frame.half_size + margin;
  const double front = cell.flat() ? margin.z : -HUGE_VAL;

  const size_t count = scene.triangles.size();
  std::vector<std::vector<uint32_t>> blocks((count + kBlock - 1) / kBlock);
  tbb::parallel_for(size_t(0), blocks.size(), [&](size_t block) {
    for (size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
      const glm::uvec3& t = scene.triangles[i];
      const glm::dvec3 corners[3] = {frame.toLocal(glm::dvec3(scene.positions[t.x])),
                                     frame.toLocal(glm::dvec3(scene.positions[t.y])),
                                     frame.toLocal(glm::dvec3(scene.positions[t.z]))};
      if (!triangleMeetsBox(corners, half_size)) continue;
      if (std::max({corners[0].z, corners[1].z, corners[2].z}) <= front) continue;
      if (hasZeroArea(scene.positions[t.x], scene.positions[t.y], scene.positions[t.z])) continue;
      blocks[block].push_back(uint32_t(i));
    }
  });
  std::vector<uint32_t> result;
  for (const std::vector<uint32_t>& block : blocks) result.insert(result.end(), block.begin(), block.end());
  return result;
}

}  // namespace sightline

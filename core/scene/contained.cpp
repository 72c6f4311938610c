#include "core/scene/contained.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/cell/cell_contains.h"
#include "core/cell/cell_frame.h"
#include "core/scene/box_triangle.h"
#include "core/scene/leaves_in_box.h"
#include "core/scene/triangle_area.h"

namespace sightline {
namespace {

/// Triangles of one task; the result does not depend on it.
constexpr size_t kBlock = 1 << 15;

/// Rounding, as a share of coordinates, between a cell's bounds in the world and its corners' places in it.
constexpr double kSlack = 0x1p-40;

/// The cell as its rays leave it.
struct RoundedCell {
  explicit RoundedCell(const ViewCell& cell) : frame(cellFrame(cell)) {
    const glm::dvec3 margin = roundingOfFaces(cell, frame);
    half_size = frame.half_size + margin;
    front = cell.flat() ? margin.z : -HUGE_VAL;
  }

  bool contains(const std::array<glm::vec3, 3>& t) const {
    const glm::dvec3 corners[3] = {frame.toLocal(glm::dvec3(t[0])), frame.toLocal(glm::dvec3(t[1])),
                                   frame.toLocal(glm::dvec3(t[2]))};
    return triangleMeetsBox(corners, half_size) &&
           std::max({corners[0].z, corners[1].z, corners[2].z}) > front && !hasZeroArea(t[0], t[1], t[2]);
  }

  CellFrame frame;
  glm::dvec3 half_size{0.0};
  double front = 0;  ///< local z that a triangle must get past
};

}  // namespace

std::vector<uint32_t> containedTriangles(const Scene& scene, const ViewCell& cell) {
  const RoundedCell rounded(cell);
  const size_t count = scene.triangleCount();
  std::vector<std::vector<uint32_t>> blocks((count + kBlock - 1) / kBlock);
  tbb::parallel_for(size_t(0), blocks.size(), [&](size_t block) {
    const auto end = uint32_t(std::min(count, (block + 1) * kBlock));
    scene.visitTriangles(uint32_t(block * kBlock), end, [&](uint32_t id, const auto& corners) {
      if (rounded.contains(corners)) blocks[block].push_back(id);
    });
  });
  std::vector<uint32_t> result;
  for (const std::vector<uint32_t>& block : blocks) result.insert(result.end(), block.begin(), block.end());
  return result;
}

std::vector<uint32_t> containedTriangles(const Scene& scene, const Bvh& bvh, const ViewCell& cell) {
  const RoundedCell rounded(cell);
  const CellFrame& frame = rounded.frame;
  const glm::dvec3 reach = glm::abs(frame.axes[0]) * rounded.half_size.x +
                           glm::abs(frame.axes[1]) * rounded.half_size.y +
                           glm::abs(frame.axes[2]) * rounded.half_size.z;
  const glm::dvec3 slack = (glm::abs(frame.center) + reach) * kSlack;
  std::vector<uint32_t> result;
  anyInLeaves(bvh, frame.center - reach - slack, frame.center + reach + slack, [&](uint32_t id) {
    if (rounded.contains(scene.corners(id))) result.push_back(id);
    return false;
  });
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());  // spatial splits give some twice
  return result;
}

}  // namespace sightline

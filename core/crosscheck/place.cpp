#include "core/crosscheck/place.h"

#include <fmt/format.h>

#include <cmath>

#include "core/base/error.h"
#include "core/scene/instances.h"

namespace sightline {

void placeElsewhere(Scene& scene, std::vector<ViewCell>& cells, double scale, double move) {
  if (scale == 1 && move == 0) return;
  scene = flatten(std::move(scene));
  for (glm::vec3& position : scene.positions) {
    position = glm::vec3(glm::dvec3(position) * scale + move);
    const glm::vec3 size = glm::abs(position);
    if (size.x <= kLargestCoordinate && size.y <= kLargestCoordinate && size.z <= kLargestCoordinate)
      continue;
    throw Error(fmt::format("scale {} and move {} put a vertex beyond {:g}", scale, move, kLargestCoordinate),
                kExitUsage);
  }
  for (ViewCell& cell : cells) {
    cell.center = cell.center * scale + move;
    cell.size *= scale;
    for (int axis = 0; axis < 3; ++axis) {
      if (cell.size[axis] == 0 || cell.size[axis] >= kSmallestExtent) continue;
      throw Error(fmt::format("scale {} makes cell {} smaller than {:g}", scale, cell.name, kSmallestExtent),
                  kExitUsage);
    }
  }
}

}  // namespace sightline

#include "core/crosscheck/place.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"

namespace sightline {

void placeElsewhere(Scene& scene, std::vector<ViewCell>& cells, double scale, double move) {
  if (scale == 1 && move == 0) return;
  for (glm::vec3& position : scene.positions) {
    position = glm::vec3(glm::dvec3(position) * scale + move);
    if (std::isfinite(position.x + position.y + position.z)) continue;
    throw Error(fmt::format("scale {} and move {} put a vertex beyond the largest float", scale, move),
                kExitUsage);
  }
  for (ViewCell& cell : cells) {
    cell.center = cell.center * scale + move;
    cell.size *= scale;
  }
}

}  // namespace sightline

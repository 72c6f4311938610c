#include "core/scene/median_edge.h"

#include <algorithm>
#include <vector>

namespace sightline {
namespace {

/// Triangles that the median is taken from.
constexpr size_t kMedianTriangles = 1 << 18;

}  // namespace

double medianEdge(const Scene& scene, std::span<const glm::vec3> remainders) {
  const auto position = [&](uint32_t vertex) {
    const glm::dvec3 rounded(scene.positions[vertex]);
    return vertex < remainders.size() ? rounded + glm::dvec3(remainders[vertex]) : rounded;
  };
  std::vector<double> edges;
  const size_t step = 1 + scene.triangles.size() / kMedianTriangles;
  for (size_t i = 0; i < scene.triangles.size(); i += step) {
    const glm::uvec3& t = scene.triangles[i];
    for (int from = 0; from < 3; ++from) {
      edges.push_back(glm::length(position(t[(from + 1) % 3]) - position(t[from])));
    }
  }
  std::erase(edges, 0.0);
  if (edges.empty()) return 0.0;
  const auto middle = edges.begin() + std::ptrdiff_t(edges.size() / 2);
  std::nth_element(edges.begin(), middle, edges.end());
  return *middle;
}

}  // namespace sightline

#include "core/scene/median_edge.h"

#include <algorithm>
#include <array>
#include <vector>

namespace sightline {
namespace {

/// Triangles that the median is taken from.
constexpr uint32_t kMedianTriangles = 1 << 18;

}  // namespace

double medianEdge(const Scene& scene, std::span<const glm::vec3> remainders) {
  const auto corners = [&](uint32_t triangle) {
    const std::array<glm::vec3, 3> rounded = scene.corners(triangle);
    std::array<glm::dvec3, 3> full = {rounded[0], rounded[1], rounded[2]};
    for (int corner = 0; !remainders.empty() && corner < 3; ++corner) {
      const uint32_t vertex = scene.vertexNumbers(triangle)[corner];
      if (vertex < remainders.size()) full[size_t(corner)] += glm::dvec3(remainders[vertex]);
    }
    return full;
  };
  std::vector<double> edges;
  const uint32_t step = 1 + scene.triangleCount() / kMedianTriangles;
  for (uint64_t i = 0; i < scene.triangleCount(); i += step) {
    const std::array<glm::dvec3, 3> corner = corners(uint32_t(i));
    for (size_t from = 0; from < 3; ++from) edges.push_back(glm::length(corner[(from + 1) % 3] - corner[from]));
  }
  std::erase(edges, 0.0);
  if (edges.empty()) return 0.0;
  const auto middle = edges.begin() + std::ptrdiff_t(edges.size() / 2);
  std::nth_element(edges.begin(), middle, edges.end());
  return *middle;
}

}  // namespace sightline

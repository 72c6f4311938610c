#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace sightline::test {

/// How the edges of triangles run, by vertex numbers.
struct EdgeCounts {
  uint64_t paired = 0;  ///< directed edges that are there once, and once the other way
  uint64_t open = 0;    ///< there once, and not the other way
  uint64_t other = 0;   ///< there more than once
};

inline EdgeCounts countEdges(std::span<const glm::uvec3> triangles) {
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> edges;
  for (const glm::uvec3& t : triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  EdgeCounts counts;
  for (const auto& [edge, times] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (times > 1) {
      ++counts.other;
    } else {
      ++(back == edges.end() ? counts.open : counts.paired);
    }
  }
  return counts;
}

/// Six times the volume that each connected set of triangles encloses, in the order of its lowest vertex.
inline std::vector<double> volumesOfPieces(std::span<const glm::uvec3> triangles,
                                           std::span<const glm::vec3> positions) {
  std::map<uint32_t, uint32_t> parent;
  const auto rootOf = [&](uint32_t v) {
    parent.try_emplace(v, v);
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const glm::uvec3& t : triangles) {
    for (int k = 1; k < 3; ++k) {
      const uint32_t a = rootOf(t.x), b = rootOf(t[k]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::map<uint32_t, double> sums;
  for (const glm::uvec3& t : triangles) {
    const uint32_t root = rootOf(t.x);
    const glm::dvec3 o = positions[root];
    sums[root] += glm::dot(glm::dvec3(positions[t.x]) - o,
                           glm::cross(glm::dvec3(positions[t.y]) - o, glm::dvec3(positions[t.z]) - o));
  }
  std::vector<double> volumes;
  for (const auto& [root, volume] : sums) volumes.push_back(volume);
  return volumes;
}

}  // namespace sightline::test

#include "core/voxel/closed_parts.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/base/error.h"

namespace sightline {
namespace {

// An edge of a triangle: vertices a < b, and whether the triangle runs from a to b.
struct HalfEdge {
  uint32_t a = 0, b = 0;
  uint32_t corner = 0;  // 3 * (triangle in the object) + corner it starts from
  bool is_forward = false;
};

// For each corner of the object's triangles a number that corners in the same place share.
std::vector<uint32_t> weld(const std::vector<glm::vec3>& corners) {
  std::vector<uint32_t> order(corners.size()), vertex(corners.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto before = [&](uint32_t i, uint32_t k) {
    const glm::vec3 &p = corners[i], &q = corners[k];
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  };
  tbb::parallel_sort(order.begin(), order.end(), before);
  uint32_t number = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && before(order[i - 1], order[i])) ++number;
    vertex[order[i]] = number;
  }
  return vertex;
}

std::vector<HalfEdge> edgesOf(const std::vector<uint32_t>& vertex) {
  std::vector<HalfEdge> edges;
  edges.reserve(vertex.size());
  for (uint32_t corner = 0; corner < vertex.size(); ++corner) {
    const uint32_t next = corner % 3 == 2 ? corner - 2 : corner + 1;
    const uint32_t from = vertex[corner], to = vertex[next];
    if (from == to) continue;
    edges.push_back({std::min(from, to), std::max(from, to), corner, from < to});
  }
  tbb::parallel_sort(edges.begin(), edges.end(), [](const HalfEdge& x, const HalfEdge& y) {
    return std::tie(x.a, x.b, x.corner) < std::tie(y.a, y.b, y.corner);
  });
  return edges;
}

// Sets of triangles that are joined one by one; each is known by its lowest.
class Sets {
 public:
  explicit Sets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t of(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(uint32_t i, uint32_t k) {
    const uint32_t a = of(i), b = of(k);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<uint32_t> parent_;
};

struct ObjectParts {
  uint64_t parts = 0, closed = 0;
  std::vector<bool> is_closed;
  std::optional<uint32_t> first_open;  // corner from which an open edge starts
};

ObjectParts partsOf(const std::vector<glm::vec3>& corners, InsideRule rule) {
  const size_t count = corners.size() / 3;
  const std::vector<HalfEdge> edges = edgesOf(weld(corners));
  Sets sets(count);
  std::vector<uint32_t> open_corners;
  for (size_t begin = 0, end; begin < edges.size(); begin = end) {
    int64_t turns = 0;
    for (end = begin; end < edges.size() && edges[end].a == edges[begin].a && edges[end].b == edges[begin].b;
         ++end) {
      sets.join(edges[begin].corner / 3, edges[end].corner / 3);
      turns += edges[end].is_forward ? 1 : -1;
    }
    const bool is_closed = rule == InsideRule::kParity ? (end - begin) % 2 == 0 : turns == 0;
    if (!is_closed) open_corners.push_back(edges[begin].corner);
  }
  std::vector<bool> is_open(count, false);
  ObjectParts result;
  for (const uint32_t corner : open_corners) {
    is_open[sets.of(corner / 3)] = true;
    result.first_open = std::min(result.first_open.value_or(corner), corner);
  }
  result.is_closed.resize(count);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t part = sets.of(i);
    result.is_closed[i] = !is_open[part];
    result.parts += part == i;
    result.closed += part == i && !is_open[part];
  }
  return result;
}

}  // namespace

ClosedParts closedParts(const Scene& scene, InsideRule rule) {
  std::vector<ObjectParts> objects(scene.objects.size());
  tbb::parallel_for(size_t{0}, objects.size(), [&](size_t i) {
    const SceneObject& object = scene.objects[i];
    std::vector<glm::vec3> corners;
    corners.reserve(size_t(object.triangle_count) * 3);
    scene.visitTriangles(object.first_triangle, object.first_triangle + object.triangle_count,
                         [&](uint32_t, const std::array<glm::vec3, 3>& triangle) {
                           corners.insert(corners.end(), triangle.begin(), triangle.end());
                         });
    objects[i] = partsOf(corners, rule);
  });
  ClosedParts result;
  result.is_closed.reserve(scene.triangleCount());
  for (size_t i = 0; i < objects.size(); ++i) {
    const ObjectParts& object = objects[i];
    result.parts += object.parts;
    result.closed += object.closed;
    result.is_closed.insert(result.is_closed.end(), object.is_closed.begin(), object.is_closed.end());
    if (!object.first_open || result.first_open) continue;
    const uint32_t id = scene.objects[i].first_triangle + *object.first_open / 3;
    const uint32_t corner = *object.first_open % 3;
    const auto corners = scene.corners(id);
    result.first_open = {corners[corner], corners[(corner + 1) % 3], id, uint32_t(i)};
  }
  return result;
}

void requireClosed(const Scene& scene, const ClosedParts& parts) {
  if (!parts.first_open) return;
  const OpenEdge& open = *parts.first_open;
  const glm::dvec3 from = glm::dvec3(open.from) + scene.offset, to = glm::dvec3(open.to) + scene.offset;
  throw Error(
      fmt::format("{} is not closed: its triangle {} has an open edge from {:g},{:g},{:g} to "
                  "{:g},{:g},{:g}; {}; close it, or say what is solid by what is reached",
                  scene.objects[open.object].name, open.triangle, from.x, from.y, from.z, to.x, to.y, to.z,
                  closedText(parts)));
}

std::string closedText(const ClosedParts& parts) {
  return fmt::format("closed parts: {} of {}", parts.closed, parts.parts);
}

}  // namespace sightline

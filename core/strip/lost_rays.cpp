#include "core/strip/lost_rays.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "core/sampling/numbered_rays.h"
#include "core/trace/sights.h"

namespace sightline {
namespace {

/// Rays that are traced at once: bounds the memory.
constexpr uint32_t kLostChunk = 1u << 21;

/// Where a triangle's corners are, in an order of their own: compressed lists of indices may turn triangles.
using SortedCorners = std::array<glm::vec3, 3>;

bool isLess(const glm::vec3& a, const glm::vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

SortedCorners sortedCorners(const Scene& scene, uint32_t id) {
  SortedCorners corners = scene.corners(id);
  std::sort(corners.begin(), corners.end(), isLess);
  return corners;
}

/// What a ray sees in a scene, whatever the ids: triangles in an order of their own, equal ones once.
void placesOf(const Scene& scene, const Sights& sights, uint32_t ray, std::vector<SortedCorners>& places) {
  places.clear();
  sights.visit(ray, [&](uint32_t id) { places.push_back(sortedCorners(scene, id)); });
  std::sort(places.begin(), places.end(), [](const SortedCorners& a, const SortedCorners& b) {
    return std::ranges::lexicographical_compare(a, b, isLess);
  });
  places.erase(std::unique(places.begin(), places.end()), places.end());
}

/// Whether a ray sees one triangle alone in both scenes, with the same corners, or nothing: as nearly all do.
bool seeOneAlike(const Scene& original, const Sights& before, const Scene& stripped, const Sights& after,
                 uint32_t ray) {
  if (!before.glass(ray).empty() || !after.glass(ray).empty()) return false;
  const uint32_t a = before.hits()[ray].triangle, b = after.hits()[ray].triangle;
  if (a == kNoTriangle || b == kNoTriangle) return a == b;
  const auto of_a = original.corners(a), of_b = stripped.corners(b);
  const auto areTurnedBy = [&](size_t k) {
    return of_a[0] == of_b[k] && of_a[1] == of_b[(k + 1) % 3] && of_a[2] == of_b[(k + 2) % 3];
  };
  return areTurnedBy(0) || areTurnedBy(1) || areTurnedBy(2);
}

/// Whether a scene has triangles of another one: asked often for the same.
class Kept {
 public:
  Kept(const Scene& original, const Scene& stripped) : original_(original), stripped_(stripped) {}

  bool has(uint32_t id) {
    const auto [entry, is_new] = known_.try_emplace(id, false);
    if (is_new) entry->second = find(sortedCorners(original_, id));
    return entry->second;
  }

 private:
  bool find(const SortedCorners& corners) const {
    for (uint32_t id = 0; id < stripped_.triangleCount(); ++id) {
      if (sortedCorners(stripped_, id) == corners) return true;
    }
    return false;
  }

  const Scene& original_;
  const Scene& stripped_;
  std::map<uint32_t, bool> known_;
};

}  // namespace

uint64_t markSeen(const TracedScene& scene, const ViewCell& cell, uint32_t cell_index, uint64_t seed,
                  uint32_t rays, std::vector<bool>& seen, const RayProgress& progress) {
  const NumberedRays numbered(cellFaces(cell), haltonShifts(seed, cell_index, RandomUse::kCounting), rays);
  std::vector<Ray> batch(std::min(rays, kLostChunk));
  Sights sights;
  uint64_t marked = 0;
  for (uint32_t first = 0; first < rays; first += kLostChunk) {
    const uint32_t count = std::min(rays - first, kLostChunk);
    tbb::parallel_for(0u, count, [&](uint32_t i) { batch[i] = numbered.at(first + i); });
    sights.trace(scene.tracer, std::span(batch).first(count));
    for (uint32_t i = 0; i < count; ++i) {
      sights.visit(i, [&](uint32_t id) {
        marked += seen[id] ? 0 : 1;
        seen[id] = true;
      });
    }
    if (progress && !progress(first + uint64_t(count))) break;
  }
  return marked;
}

LostRays countLostRays(const TracedScene& original, const TracedScene& stripped, const ViewCell& cell,
                       uint32_t cell_index, uint64_t seed, uint32_t& rays, const RayProgress& progress) {
  const NumberedRays numbered(cellFaces(cell), haltonShifts(seed, cell_index, RandomUse::kChecking), rays);
  std::vector<Ray> batch(std::min(rays, kLostChunk));
  Sights before, after;
  std::vector<SortedCorners> places_before, places_after;
  Kept kept(original.scene, stripped.scene);
  LostRays result;
  for (uint32_t first = 0; first < rays; first += kLostChunk) {
    const uint32_t count = std::min(rays - first, kLostChunk);
    tbb::parallel_for(0u, count, [&](uint32_t i) { batch[i] = numbered.at(first + i); });
    before.trace(original.tracer, std::span(batch).first(count));
    after.trace(stripped.tracer, std::span(batch).first(count));
    std::vector<uint8_t> alike(count);
    tbb::parallel_for(0u, count, [&](uint32_t i) {
      alike[i] = seeOneAlike(original.scene, before, stripped.scene, after, i) ? 1 : 0;
    });
    for (uint32_t i = 0; i < count; ++i) {
      if (alike[i] != 0) continue;
      placesOf(original.scene, before, i, places_before);
      placesOf(stripped.scene, after, i, places_after);
      if (places_before == places_after) continue;
      bool lost = false;
      before.visit(i, [&](uint32_t id) { lost = lost || !kept.has(id); });
      ++(lost ? result.lost : result.ties);
    }
    if (progress && !progress(first + uint64_t(count))) rays = first + count;
  }
  return result;
}

}  // namespace sightline

#include "core/strip/lost_rays.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "core/sampling/numbered_rays.h"

namespace sightline {
namespace {

/// Rays that are traced at once: bounds the memory.
constexpr uint32_t kLostChunk = 1u << 21;

/// Compressed lists of indices may turn triangles: their corners in an order of their own.
std::array<glm::vec3, 3> sorted(std::array<glm::vec3, 3> corners) {
  std::sort(corners.begin(), corners.end(), [](const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  });
  return corners;
}

/// Whether the rays' first hits are the same, or nothing in both scenes.
bool isSame(const Scene& original, const Hit& before, const Scene& stripped, const Hit& after) {
  if (before.triangle == kNoTriangle) return after.triangle == kNoTriangle;
  if (after.triangle == kNoTriangle) return false;
  return sorted(original.corners(before.triangle)) == sorted(stripped.corners(after.triangle));
}

bool holds(const Scene& scene, const std::array<glm::vec3, 3>& corners) {
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    if (sorted(scene.corners(id)) == corners) return true;
  }
  return false;
}

}  // namespace

uint64_t markSeen(const TracedScene& scene, const ViewCell& cell, uint32_t cell_index, uint64_t seed,
                  uint32_t rays, std::vector<bool>& seen, const RayProgress& progress) {
  const NumberedRays numbered(cellFaces(cell), haltonShifts(seed, cell_index, RandomUse::kCounting), rays);
  std::vector<Ray> batch(std::min(rays, kLostChunk));
  std::vector<Hit> hits(batch.size());
  uint64_t marked = 0;
  for (uint32_t first = 0; first < rays; first += kLostChunk) {
    const uint32_t count = std::min(rays - first, kLostChunk);
    tbb::parallel_for(0u, count, [&](uint32_t i) { batch[i] = numbered.at(first + i); });
    scene.tracer.traceRays(std::span(batch).first(count), std::span(hits).first(count));
    for (uint32_t i = 0; i < count; ++i) {
      if (hits[i].triangle == kNoTriangle || seen[hits[i].triangle]) continue;
      seen[hits[i].triangle] = true;
      ++marked;
    }
    if (progress && !progress(first + uint64_t(count))) break;
  }
  return marked;
}

LostRays countLostRays(const TracedScene& original, const TracedScene& stripped, const ViewCell& cell,
                       uint32_t cell_index, uint64_t seed, uint32_t& rays, const RayProgress& progress) {
  const NumberedRays numbered(cellFaces(cell), haltonShifts(seed, cell_index, RandomUse::kChecking), rays);
  std::vector<Ray> batch(std::min(rays, kLostChunk));
  std::vector<Hit> before(batch.size()), after(batch.size());
  std::map<uint32_t, bool> known;  // whether the other scene has a triangle of the original
  LostRays result;
  for (uint32_t first = 0; first < rays; first += kLostChunk) {
    const uint32_t count = std::min(rays - first, kLostChunk);
    tbb::parallel_for(0u, count, [&](uint32_t i) { batch[i] = numbered.at(first + i); });
    original.tracer.traceRays(std::span(batch).first(count), std::span(before).first(count));
    stripped.tracer.traceRays(std::span(batch).first(count), std::span(after).first(count));
    for (uint32_t i = 0; i < count; ++i) {
      if (isSame(original.scene, before[i], stripped.scene, after[i])) continue;
      const uint32_t id = before[i].triangle;
      const auto [entry, is_new] = known.try_emplace(id, true);
      if (is_new && id != kNoTriangle) {
        entry->second = holds(stripped.scene, sorted(original.scene.corners(id)));
      }
      ++(entry->second ? result.ties : result.lost);
    }
    if (progress && !progress(first + uint64_t(count))) rays = first + count;
  }
  return result;
}

}  // namespace sightline

#include "core/strip/lost_rays.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
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

bool isLost(const Scene& original, const Hit& before, const Scene& stripped, const Hit& after) {
  if (before.triangle == kNoTriangle) return false;
  if (after.triangle == kNoTriangle) return true;
  return sorted(original.corners(before.triangle)) != sorted(stripped.corners(after.triangle));
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

uint64_t countLostRays(const TracedScene& original, const TracedScene& stripped, const ViewCell& cell,
                       uint32_t cell_index, uint64_t seed, uint32_t& rays, const RayProgress& progress) {
  const NumberedRays numbered(cellFaces(cell), haltonShifts(seed, cell_index, RandomUse::kChecking), rays);
  std::vector<Ray> batch(std::min(rays, kLostChunk));
  std::vector<Hit> before(batch.size()), after(batch.size());
  uint64_t lost = 0;
  for (uint32_t first = 0; first < rays; first += kLostChunk) {
    const uint32_t count = std::min(rays - first, kLostChunk);
    tbb::parallel_for(0u, count, [&](uint32_t i) { batch[i] = numbered.at(first + i); });
    original.tracer.traceRays(std::span(batch).first(count), std::span(before).first(count));
    stripped.tracer.traceRays(std::span(batch).first(count), std::span(after).first(count));
    lost += tbb::parallel_reduce(
        tbb::blocked_range<uint32_t>(0, count, 1 << 14), uint64_t(0),
        [&](const tbb::blocked_range<uint32_t>& range, uint64_t sum) {
          for (uint32_t i = range.begin(); i != range.end(); ++i) {
            sum += isLost(original.scene, before[i], stripped.scene, after[i]) ? 1 : 0;
          }
          return sum;
        },
        std::plus<>());
    if (progress && !progress(first + uint64_t(count))) rays = first + count;
  }
  return lost;
}

}  // namespace sightline

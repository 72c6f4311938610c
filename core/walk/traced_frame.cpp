#include "core/walk/traced_frame.h"

#include "core/draw/optimal_counts.h"
#include "core/draw/pvs_units.h"

namespace sightline {
namespace {

/// Devices snap corners to 1/256 pixel: edges of two triangles differ by at most twice half of that.
constexpr double kEdge = 1.0 / 128;

}  // namespace

Ray pixelRay(const Camera& camera, uint32_t x, uint32_t y, double right, double down) {
  const glm::dvec3 across(camera.across), low(camera.down);
  const double a = 2 * (x + 0.5 + right) / camera.size.x - 1, b = 2 * (y + 0.5 + down) / camera.size.y - 1;
  const glm::dvec3 direction =
      glm::dvec3(camera.forward) + across * (a / glm::dot(across, across)) + low * (b / glm::dot(low, low));
  return {glm::vec4(glm::vec3(camera.eye), 0), glm::vec4(glm::vec3(direction), 0)};
}

TracedFrame traceOptimal(Tracer& tracer, const Drawables& drawables, const Camera& camera, uint32_t frame,
                         std::span<const uint32_t> reference, const WalkClock& clock) {
  const uint32_t width = camera.size.x, height = camera.size.y;
  std::vector<Ray> rays;
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) rays.push_back(pixelRay(camera, x, y));
  }
  std::vector<Hit> hits(rays.size());
  const double start = clock();
  tracer.traceRays(rays, hits);
  TracedFrame result{.frame = frame, .milliseconds = clock() - start};
  const std::vector<uint32_t> owner = drawableOfTriangles(drawables);
  std::vector<uint32_t> ids, counts, others;
  for (const Hit& hit : hits) ids.push_back(hit.triangle);
  for (const Drawable& drawable : drawables.list) counts.push_back(drawable.triangle_count);
  const OptimalCounts optimal = countOptimal(ids, owner, counts);
  result.drawables = optimal.drawables;
  result.triangles = optimal.triangles;
  result.drawable_triangles = optimal.drawable_triangles;
  const auto ownerOf = [&](uint32_t id) { return id == kNoTriangle ? kNoTriangle : owner[id]; };
  rays.clear();
  for (uint32_t pixel = 0; pixel < ids.size(); ++pixel) {
    if (ownerOf(ids[pixel]) == reference[pixel]) continue;
    others.push_back(pixel);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx)
        rays.push_back(pixelRay(camera, pixel % width, pixel / width, dx * kEdge, dy * kEdge));
    }
  }
  hits.resize(rays.size());
  tracer.traceRays(rays, hits);
  result.other_pixels = others.size();
  for (size_t i = 0; i < others.size(); ++i) {
    const auto around = std::span(hits).subspan(9 * i, 9);
    const bool explained = std::ranges::any_of(
        around, [&](const Hit& hit) { return ownerOf(hit.triangle) == reference[others[i]]; });
    result.unexplained_pixels += explained ? 0 : 1;
  }
  return result;
}

}  // namespace sightline

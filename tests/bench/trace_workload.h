#pragma once
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <vector>

#include "bvh/bvh.h"
#include "core/cell/view_cell.h"
#include "core/generate/generate.h"
#include "core/sampling/make_stage_params.h"
#include "core/sampling/random_segment.h"
#include "core/shared/gvs_border.h"
#include "core/shared/random_ray.h"
#include "core/trace/cpu_tracer.h"

// The rays of bench_trace: random ones of cells in a generated city, and border rays of what they hit.
namespace sightline {

/// The rays of one face of a cell: a run of the Halton sequence.
struct Run {
  Face face;
  RandomSegment segment;
  size_t first;  ///< place of its rays and hits in the arrays of all
};

struct Workload {
  Scene scene;
  Bvh bvh;
  std::vector<Run> runs;
  std::vector<Ray> random;  ///< in Halton order
  std::vector<Ray> border;
};

inline constexpr uvec4 kShifts(2654435769u, 40531527u, 205459861u, 31655765u);

inline float area(const Face& face) {
  return glm::length(vec3(face.edge_u)) * glm::length(vec3(face.edge_v));
}

inline void addRandomRays(Workload& work, const ViewCell& cell, uint32_t count) {
  const std::vector<Face> faces = cellFaces(cell);
  float total = 0;
  for (const Face& face : faces) total += area(face);
  uint64_t index = 0;
  for (uint32_t i = 0; i < faces.size(); ++i) {
    const uint32_t share = std::max(1u, uint32_t(double(count) * area(faces[i]) / total));
    work.runs.push_back({faces[i], makeRandomSegment(i, index, share, 1), work.random.size()});
    const size_t first = work.random.size();
    work.random.resize(first + share);
    tbb::parallel_for(0u, share,
                      [&](uint32_t k) { work.random[first + k] = randomRay(index, k, faces[i], kShifts); });
    index += share;
  }
}

/// Border rays of the triangles that a cell's rays found, all samples, in ascending id, each from the first
/// ray's origin: as the device's list has them after a batch.
inline void addBorderRays(Workload& work, const CpuTracer& tracer, const ViewCell& cell, size_t first,
                          size_t count) {
  BakeParams defaults;
  defaults.abs_spacing = 0;
  const StageParams params = makeStageParams(defaults, cellFaces(cell), uvec4(0));
  const uint32_t samples = params.counts.x, per_entry = borderRayCount(samples, params);
  std::map<uint32_t, vec3> found;
  for (size_t i = first; i < work.random.size() && found.size() * per_entry < count; ++i) {
    const Hit hit = tracer.trace(work.random[i]);
    if (hit.triangle != kNoTriangle) found.emplace(hit.triangle, vec3(work.random[i].origin));
  }
  for (const auto& [id, origin] : found) {
    const glm::uvec3 v = work.scene.triangles[id];
    const auto& p = work.scene.positions;
    for (uint32_t k = 0; k < per_entry; ++k) {
      const Ray ray = polygonRay(p[v.x], p[v.y], p[v.z], k, samples, origin, params);
      if (hasDirection(ray)) work.border.push_back(ray);
    }
  }
}

/// rays: random ones of each of three cells. Throws Error.
inline Workload makeWorkload(uint64_t triangles, uint32_t rays, const BvhConfig& config) {
  Workload work;
  work.scene = generateScene("city", triangles, 1);
  work.bvh = buildBvh(work.scene.positions, work.scene.triangles, config);
  const CpuTracer tracer(work.scene, work.bvh);
  for (const ViewCell& cell : generateCells("city", triangles, 1)) {
    if (!cell.name.ends_with("-1")) continue;
    const size_t first = work.random.size();
    addRandomRays(work, cell, rays);
    addBorderRays(work, tracer, cell, first, rays / 2);
  }
  return work;
}

}  // namespace sightline

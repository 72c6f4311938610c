#pragma once
#ifdef SL_HAVE_EMBREE
#include <embree3/rtcore.h>

#include <cstring>

#include "tests/bench/trace_contestants.h"

// Embree 3, the peer of bench_trace: robust, single rays, all threads.
namespace sightline {

inline void traceEmbree(RTCScene scene, const std::vector<Ray>& rays, std::vector<Hit>& hits) {
  tbb::parallel_for(size_t{0}, (rays.size() + kTraceChunk - 1) / kTraceChunk, [&](size_t chunk) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = chunk * kTraceChunk; i < std::min(rays.size(), (chunk + 1) * kTraceChunk); ++i) {
      const Ray& ray = rays[i];
      RTCRayHit query{};
      query.ray = {ray.origin.x,
                   ray.origin.y,
                   ray.origin.z,
                   0,
                   ray.direction.x,
                   ray.direction.y,
                   ray.direction.z,
                   0,
                   INFINITY,
                   0xffffffffu,
                   0,
                   0};
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene, &context, &query);
      hits[i] = {query.ray.tfar,
                 query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? kNoTriangle : query.hit.primID};
    }
  });
}

inline Contestant embreeContestant(const Workload& work) {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const auto& p = work.scene.positions;
  const auto& t = work.scene.triangles;
  std::memcpy(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, p.size()),
              p.data(), p.size() * 12);
  std::memcpy(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, t.size()),
              t.data(), t.size() * 12);
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(scene, mesh);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcCommitScene(scene);
  auto random = std::make_shared<std::vector<Hit>>(work.random.size());
  auto border = std::make_shared<std::vector<Hit>>(work.border.size());
  return {"embree", [&work, scene, random] { traceEmbree(scene, work.random, *random); },
          [&work, scene, border] { traceEmbree(scene, work.border, *border); }, [random] { return *random; },
          [border] { return *border; }};
}
}  // namespace sightline
#endif

#pragma once
#include <vector>

#include "bvh/bvh.h"
#include "core/scene/scene.h"
#include "core/shared/types.h"
#include "core/trace/trace_layout.h"

namespace sightline {

/// Nearest hits in plain C++: the reference for every other tracer, and the whole of tracing where there is
/// no OpenCL. Thread-safe after construction.
class CpuTracer {
 public:
  /// Copies the triangles; refers to the tree, which must outlive the tracer. Throws Error if the tree is
  /// too deep to trace.
  CpuTracer(const Scene& scene, const Bvh& bvh);

  /// The same from triangles already packed, in the order of bvh.references. One level only.
  CpuTracer(std::vector<TriangleRecord> triangles, const Bvh& bvh);

  /// Smallest t, among equal t the lowest id, of what ends the ray (Tracer::traceRays). A direction of zero
  /// hits nothing; where the scene's reach / direction leaves 2^-60 .. 2^80, hits may be lost.
  Hit trace(const Ray& ray) const;

  /// As trace. glass: becomes the hits on glass no farther away than the ray's own, by id, each once.
  Hit traceThrough(const Ray& ray, std::vector<Hit>& glass) const;

  /// What kinds of surfaces there are that a ray does not simply end on.
  const SurfaceFeatures& features() const { return features_; }

  /// hits[i] = trace(rays[i]), faster where rays next to each other go the same way.
  void tracePacket(const Ray* rays, Hit* hits, int count) const;

  /// Bytes that the tracer added to those of the tree.
  uint64_t memoryBytes() const {
    return triangles_.size() * sizeof(TriangleRecord) + surfaces_.size() * sizeof(uint32_t);
  }

 private:
  template <bool kSurfaces>
  Hit walk(const Ray& ray, std::vector<Hit>* glass) const;

  template <bool kSurfaces>
  Hit traceInstances(const Ray& ray, std::vector<Hit>* glass) const;

  const Bvh& bvh_;
  std::vector<TriangleRecord> triangles_;
  std::vector<uint32_t> surfaces_;  ///< packSurfaces; empty: all are opaque from both sides
  SurfaceFeatures features_;
  float scene_reach_;
};

}  // namespace sightline

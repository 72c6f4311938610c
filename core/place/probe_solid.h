#pragma once
#include <glm/glm.hpp>

#include "core/scene/in_solid.h"
#include "core/trace/cpu_tracer.h"

namespace sightline {

/// Traces the rays of inSolid (core/scene/in_solid.h) from places. For use by many threads at once.
class SolidProbe {
 public:
  SolidProbe(const Scene& scene, const CpuTracer& tracer, FreeSide free_side)
      : scene_(scene), tracer_(tracer), free_side_(free_side) {}

  bool isInSolid(const glm::dvec3& place) const {
    if (free_side_ == FreeSide::kAny) return false;
    const glm::vec3 from(place);
    std::array<Hit, kSolidProbes> hits;
    for (size_t i = 0; i < hits.size(); ++i) {
      const glm::vec3& to = directions_[i];
      hits[i] = tracer_.trace({{from.x, from.y, from.z, 0}, {to.x, to.y, to.z, 0}});
    }
    return inSolid(scene_, free_side_, directions_, hits);
  }

 private:
  const Scene& scene_;
  const CpuTracer& tracer_;
  FreeSide free_side_;
  std::array<glm::vec3, kSolidProbes> directions_ = solidProbes();
};

}  // namespace sightline

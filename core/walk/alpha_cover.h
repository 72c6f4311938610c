#pragma once
#include <memory>
#include <optional>
#include <span>

#include "core/draw/drawables.h"
#include "core/shared/camera.h"
#include "core/trace/cpu_tracer.h"

namespace sightline {

/// What one looks through: surfaces with holes, and glass. Tells which pixels show something behind them, as
/// sets and methods go wrong there for other reasons than elsewhere. Costs nothing where the scene has none.
class AlphaCover {
 public:
  AlphaCover(const Scene& scene, const Drawables& drawables);

  bool any() const { return tracer_.has_value(); }

  /// How many of the pixels (row by row from the top) show through a masked or blended triangle what is drawn
  /// in them: a ray through their middle meets one before. depth: of all pixels, reversed (near plane by
  /// distance along `forward`).
  uint64_t count(const Camera& camera, std::span<const size_t> pixels, std::span<const float> depth) const;

 private:
  Scene covers_;
  Bvh bvh_;
  std::optional<CpuTracer> tracer_;
};

}  // namespace sightline

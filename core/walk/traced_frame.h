#pragma once
#include "core/walk/replay.h"

namespace sightline {

/// Traces a frame. reference: the drawable that each pixel shows where all is drawn (WalkPlayer).
TracedFrame traceOptimal(Tracer& tracer, const Drawables& drawables, const Camera& camera, uint32_t frame,
                         std::span<const uint32_t> reference, const WalkClock& clock);

}  // namespace sightline

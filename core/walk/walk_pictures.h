#pragma once
#include <cstdint>
#include <span>

#include "core/draw/drawables.h"
#include "core/picture/png.h"
#include "core/shared/camera.h"
#include "core/trace/tracer.h"

namespace sightline {

/// A frame as it should be, grey, its false pixels (numbers, row by row) red. tracer: of the scene.
Image falsePicture(const Scene& scene, Tracer& tracer, const Camera& camera, std::span<const size_t> pixels);

/// The whole scene obliquely from above, what a frame drew green, the rest grey, what the camera sees between
/// orange lines. drawn: drawables. size: pixels across.
Image drawnPicture(const Scene& scene, Tracer& tracer, const Drawables& drawables,
                   std::span<const uint32_t> drawn, const Camera& camera, uint32_t size = 720);

}  // namespace sightline

#pragma once
#include <cstdint>
#include <span>

#include "core/picture/png.h"
#include "core/scene/scene.h"
#include "core/shared/view_ray.h"
#include "core/trace/seen_glass.h"

namespace sightline {

/// One view of the pixel error as a picture: the scene shaded, behind tinted glass where there is any, wrong
/// pixels red (markMissing). triangles: of its pixels, as of Tracer::traceViews; glass: as of
/// Tracer::traceGlass for rays that are its pixels; member: membership (core/picture/shading.h) of the set.
Image viewPicture(const Scene& scene, const ViewFrame& frame, uint32_t resolution,
                  std::span<const uint32_t> triangles, std::span<const SeenThrough> glass,
                  std::span<const uint8_t> member);

}  // namespace sightline

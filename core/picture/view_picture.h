#pragma once
#include <cstdint>
#include <span>

#include "core/picture/png.h"
#include "core/scene/scene.h"
#include "core/shared/view_ray.h"

namespace sightline {

/// One view of the pixel error as a picture: the scene shaded, wrong pixels red (markMissing). triangles: of
/// its pixels, as of Tracer::traceViews; member: membership (core/picture/shading.h) of the set.
Image viewPicture(const Scene& scene, const ViewFrame& frame, uint32_t resolution,
                  std::span<const uint32_t> triangles, std::span<const uint8_t> member);

}  // namespace sightline

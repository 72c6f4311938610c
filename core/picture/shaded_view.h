#pragma once
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "core/picture/outside_camera.h"
#include "core/picture/picture.h"

namespace sightline {

/// Colours of triangles, linear light; of those that one looks at, and those that one looks through.
struct TriangleColors {
  std::function<glm::vec3(uint32_t triangle)> solid, glass;
};

/// A picture, and what else its rays found.
struct ShadedView {
  Picture picture;
  std::vector<float> depths;  ///< of each pixel, along the camera's forward; infinite: the sky
};

/// The scene in the light of a sun over the viewer's left shoulder, 2 x 2 samples a pixel. Throws Error.
ShadedView renderShaded(const TraceRays& trace, const Scene& scene, const OutsideView& view,
                        const TriangleColors& colors, const PictureOptions& options, const TraceGlass& glass);

}  // namespace sightline

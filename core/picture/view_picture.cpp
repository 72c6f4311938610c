#include "core/picture/view_picture.h"

#include <tbb/parallel_for.h>

#include <vector>

#include "core/picture/mark_pixels.h"
#include "core/picture/shading.h"

namespace sightline {

Image viewPicture(const Scene& scene, const ViewFrame& frame, uint32_t resolution,
                  std::span<const uint32_t> triangles, std::span<const uint8_t> member) {
  Image image(resolution, resolution);
  const glm::vec3 to_sun = glm::normalize(glm::vec3(0.5f, 0.8f, 0.35f));
  tbb::parallel_for(0u, resolution, [&](uint32_t y) {
    for (uint32_t x = 0; x < resolution; ++x) {
      const uint32_t triangle = triangles[size_t(y) * resolution + x];
      const glm::vec3 direction = glm::normalize(glm::vec3(viewRay(frame, x, y, resolution).direction));
      const glm::vec3 light =
          triangle == kNoTriangle
              ? skyColor(std::max(0.0f, direction.y))
              : kHiddenColor * lightOn(facingNormal(scene, triangle, direction), direction, to_sun, 1);
      image.at(x, y) = encode(light);
    }
  });
  std::vector<size_t> wrong;
  for (size_t pixel = 0; pixel < triangles.size(); ++pixel) {
    if (triangles[pixel] != kNoTriangle && member[triangles[pixel]] == 0) wrong.push_back(pixel);
  }
  markMissing(image, wrong);
  return image;
}

}  // namespace sightline

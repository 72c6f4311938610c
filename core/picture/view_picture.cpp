#include "core/picture/view_picture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "core/picture/mark_pixels.h"
#include "core/picture/shading.h"

namespace sightline {

Image viewPicture(const Scene& scene, const ViewFrame& frame, uint32_t resolution,
                  std::span<const uint32_t> triangles, std::span<const SeenThrough> glass,
                  std::span<const uint8_t> member) {
  Image image(resolution, resolution);
  const glm::vec3 to_sun = glm::normalize(glm::vec3(0.5f, 0.8f, 0.35f));
  tbb::parallel_for(0u, resolution, [&](uint32_t y) {
    auto pane = std::ranges::lower_bound(glass, y * resolution, {}, &SeenThrough::ray);
    for (uint32_t x = 0; x < resolution; ++x) {
      const uint32_t triangle = triangles[size_t(y) * resolution + x];
      const auto begin = pane;
      while (pane != glass.end() && pane->ray == y * resolution + x) ++pane;
      const glm::vec3 direction = glm::normalize(glm::vec3(viewRay(frame, x, y, resolution).direction));
      const glm::vec3 light =
          triangle == kNoTriangle
              ? skyColor(std::max(0.0f, direction.y))
              : kHiddenColor * lightOn(facingNormal(scene, triangle, direction), direction, to_sun, 1);
      image.at(x, y) = encode(throughGlass(scene, light, {begin, pane}, direction, to_sun,
                                           [](uint32_t) { return kHiddenGlassColor; }));
    }
  });
  std::vector<size_t> wrong;
  auto pane = glass.begin();
  for (size_t pixel = 0; pixel < triangles.size(); ++pixel) {
    bool is_wrong = triangles[pixel] != kNoTriangle && member[triangles[pixel]] == 0;
    for (; pane != glass.end() && pane->ray == pixel; ++pane) is_wrong |= member[pane->triangle] == 0;
    if (is_wrong) wrong.push_back(pixel);
  }
  markMissing(image, wrong);
  return image;
}

}  // namespace sightline

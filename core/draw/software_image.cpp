#include "core/draw/software_image.h"

#include <numeric>

#include "core/draw/raster_triangle.h"
#include "core/scene/instances.h"
#include "core/shared/surface.h"

namespace sightline {

SoftwareImage::SoftwareImage(const Scene& scene) : scene_(scene) {
  if (scene.surfaces.empty()) return;
  std::vector<uint32_t> order(scene.triangleCount());
  std::iota(order.begin(), order.end(), 0u);
  const Surfaces flat = scene.hasInstances() ? flatSurfaces(scene) : Surfaces();
  surfaces_ = packSurfaces(scene.hasInstances() ? flat : scene.surfaces, order);
}

void SoftwareImage::begin(const Camera& camera) {
  camera_ = camera;
  depth_.assign(size_t{width()} * height(), 0.0f);
  ids_.assign(depth_.size(), kNoTriangle);
}

bool SoftwareImage::draw(uint32_t id, bool writes) {
  const uint32_t surface = surfaces_.empty() ? 0u : surfaces_[kSurfaceHeaderWords + id];
  bool drawn = false;
  rasterTriangle(camera_, scene_.corners(id), [&](const RasterPixel& pixel) {
    if ((surface & kSurfaceFrontOnly) != 0 && !pixel.front) return false;
    const size_t at = size_t{pixel.y} * width() + pixel.x;
    if (!(pixel.depth > depth_[at])) return true;
    if ((surface & kSurfaceMasked) != 0 &&
        !maskHolds(surfaces_.data(), surface & kSurfaceIndex, pixel.share_b, pixel.share_c)) {
      return true;
    }
    drawn = true;
    if (writes) {
      depth_[at] = pixel.depth;
      ids_[at] = id;
    }
    return writes;
  });
  return drawn;
}

bool SoftwareImage::seesBox(const AxisBox& box) const {
  const auto corner = [&](int i) {
    return glm::vec3((i & 1) != 0 ? box.high.x : box.low.x, (i & 2) != 0 ? box.high.y : box.low.y,
                     (i & 4) != 0 ? box.high.z : box.low.z);
  };
  // Two triangles a face: corners by the bits of x, y and z.
  static constexpr int kFaces[12][3] = {{0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                                        {2, 3, 7}, {2, 7, 6}, {0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}};
  for (const auto& face : kFaces) {
    bool seen = false;
    rasterTriangle(camera_, {corner(face[0]), corner(face[1]), corner(face[2])},
                   [&](const RasterPixel& pixel) {
                     seen = pixel.depth >= depth_[size_t{pixel.y} * width() + pixel.x];
                     return !seen;
                   });
    if (seen) return true;
  }
  return false;
}

}  // namespace sightline

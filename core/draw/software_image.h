#pragma once
#include <array>
#include <vector>

#include "bvh/axis_box.h"
#include "core/scene/scene.h"
#include "core/shared/camera.h"

namespace sightline {

/// An image drawn by the processor as Vulkan's rules have it: corners by clipPosition, cut off at the near
/// plane, snapped to 1/256 pixel; a pixel belongs to the triangle that its middle is in, on an edge to the
/// one of which it is the top or left edge; depth is linear in the image, in double, rounded to float. The
/// same triangles in any order give the same depth, bit for bit. Meant for tests and for where there is no
/// device: it takes its time.
class SoftwareImage {
 public:
  /// Of the scene's triangles. The scene must outlive it.
  explicit SoftwareImage(const Scene& scene);

  /// Empties the image: depth 0 and no ids. The camera stays until the next time.
  void begin(const Camera& camera);

  /// Draws triangle `id` where it is nearer than what is there. writes: as opaque and masked triangles do;
  /// without, it changes nothing. Holes and back faces that the scene's surfaces have are left out. Returns
  /// whether a pixel is drawn.
  bool draw(uint32_t id, bool writes = true);

  /// Whether a pixel of the box's faces is at least as near as what is there.
  bool seesBox(const AxisBox& box) const;

  uint32_t width() const { return camera_.size.x; }
  uint32_t height() const { return camera_.size.y; }
  /// Row by row from the top.
  const std::vector<float>& depth() const { return depth_; }
  const std::vector<uint32_t>& ids() const { return ids_; }  ///< kNoTriangle: none

 private:
  const Scene& scene_;
  Camera camera_{};
  std::vector<float> depth_;
  std::vector<uint32_t> ids_;
  std::vector<uint32_t> surfaces_;  ///< as core/shared/surface.h reads them, in the order of ids; empty: none
};

}  // namespace sightline

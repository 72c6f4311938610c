#include "core/picture/cell_overlay.h"
#include "core/picture/outside_camera.h"
#include "core/picture/picture.h"
#include "core/picture/shaded_view.h"
#include "core/picture/shading.h"

namespace sightline {

Picture renderOutside(const TraceRays& trace, const Scene& scene, const CellPvs& pvs,
                      const PictureOptions& options, const TraceGlass& glass, const CellPvs* upper) {
  checkSize(options.width, options.height);
  const std::vector<uint8_t> member = membership(scene, pvs.triangles);
  const std::vector<uint8_t> open =
      upper == nullptr ? std::vector<uint8_t>{} : membership(scene, upper->triangles);
  const OutsideView view = placeOutsideView(trace, scene, pvs, member, options);
  const auto colorOf = [&](uint32_t triangle, const glm::vec3& visible, const glm::vec3& hidden) {
    if (member[triangle] != 0) return visible;
    if (upper == nullptr) return hidden;
    return open[triangle] != 0 ? kOpenColor : kProvedHiddenColor;
  };
  const TriangleColors colors = {
      [&](uint32_t triangle) { return colorOf(triangle, kVisibleColor, kHiddenColor); },
      [&](uint32_t triangle) { return colorOf(triangle, kVisibleGlassColor, kHiddenGlassColor); }};
  ShadedView shaded = renderShaded(trace, scene, view, colors, options, glass);
  drawCell(shaded.picture.image, shaded.depths, view.camera, pvs.cell);
  return std::move(shaded.picture);
}

Picture renderWhole(const TraceRays& trace, const Scene& scene,
                    const std::function<glm::vec3(uint32_t triangle)>& color, const PictureOptions& options) {
  checkSize(options.width, options.height);
  return renderShaded(trace, scene, placeWholeView(sceneBounds(scene), options), {color, color}, options, {})
      .picture;
}

}  // namespace sightline

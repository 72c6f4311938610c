#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/picture/png.h"
#include "core/pvs/cell_pvs.h"
#include "core/scene/scene.h"
#include "core/trace/seen_glass.h"

namespace sightline {

/// Finds the nearest hits of rays, one each: Tracer::traceRays.
using TraceRays = std::function<void(std::span<const Ray> rays, std::span<Hit> hits)>;
/// The glass that rays meet on their way to these hits: Tracer::traceGlass. Empty: there is none.
using TraceGlass =
    std::function<std::vector<SeenThrough>(std::span<const Ray> rays, std::span<const Hit> hits)>;

/// Sides of a picture, pixels.
inline constexpr uint32_t kMinPictureSide = 16, kMaxPictureSide = 16384;

/// Where the scene is cut open so that a ceiling does not hide the rooms below it.
enum class CutMode {
  kAuto,   ///< just below the ceiling above the cell, if most of the cell has one
  kNone,   ///< nowhere
  kHeight  ///< at cut_height
};

struct PictureOptions {
  uint32_t width = 1280;  ///< pixels
  uint32_t height = 960;  ///< pixels
  CutMode cut = CutMode::kAuto;
  float cut_height = 0;  ///< world y; what lies above is left out of the view from outside
};

/// A rendered picture and what can be counted in it.
struct Picture {
  Image image;
  uint64_t scene_pixels = 0;    ///< that show a triangle
  uint64_t missing_pixels = 0;  ///< view from inside: that show a triangle outside the PVS (pure red)
  std::vector<uint32_t> missing_triangles;  ///< view from inside: those triangles, ascending
};

/// The view cell and what lies around it, obliquely from above, from the side that shows most of the PVS:
/// triangles of the PVS green, the rest grey, the cell as an orange box, fainter where something hides it.
/// 2 x 2 samples a pixel; y is up. Through the holes of masks one sees what is behind, and through glass,
/// which tints it: bluish green where it is in the PVS, bluish grey where not. With `upper`, the same cell's
/// upper bound, what is not in the PVS has two colours: ochre where the bound leaves it open, dark grey where
/// it is not in the bound, so proved hidden. Throws Error.
Picture renderOutside(const TraceRays& trace, const Scene& scene, const CellPvs& pvs,
                      const PictureOptions& options = {}, const TraceGlass& glass = {},
                      const CellPvs* upper = nullptr);

/// A scene whole, obliquely from above, each triangle in its colour (linear light). options.cut has no
/// effect. Throws Error.
Picture renderWhole(const TraceRays& trace, const Scene& scene,
                    const std::function<glm::vec3(uint32_t triangle)>& color,
                    const PictureOptions& options = {});

/// What is seen from the cell, on one sheet of three panoramas: the cell's centre above, two points of its
/// surface below. A box looks all around (360 by 180 degrees), a flat cell along its normal (180 by 90).
/// Pixels that show a triangle outside the PVS, glass that is seen through too, are (255, 0, 0), nothing else
/// is; where they are few, each has a ring around it. Throws Error.
Picture renderInside(const TraceRays& trace, const Scene& scene, const CellPvs& pvs,
                     const PictureOptions& options = {}, const TraceGlass& glass = {});

}  // namespace sightline

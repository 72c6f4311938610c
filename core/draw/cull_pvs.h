#pragma once
#include <memory>
#include <span>

#include "core/draw/cull_method.h"
#include "core/draw/draw_scene.h"
#include "core/draw/pvs_units.h"

// The methods that draw what a set says is seen from the camera's cell. What the bake missed is missing in
// the image.
namespace sightline {

/// What to draw where the camera is in no cell.
enum class OutsideCells {
  all,      ///< everything (with the frustum: everything that the image may show)
  nearest,  ///< what the nearest cell sees; all, if there are no cells
  error,    ///< throw Error
};

/// Which cell a frame draws.
struct CellChoice {
  OutsideCells outside = OutsideCells::all;
  /// Of each frame of a walk, by its number; empty: the cell that the camera is in. Must outlive who uses it.
  std::span<const uint32_t> of_frames = {};
};

/// Draws the cell's triangles by its list: QueryBackend::submitList of the cell's number in units.triangles,
/// which the backend was made with. Throws Error that names the frame and the place, with
/// OutsideCells::error. Scene and units must outlive the method.
std::unique_ptr<CullMethod> cullPvsList(const DrawScene& scene, const PvsUnits& units,
                                        const CellChoice& choice);

/// Draws the drawables with a triangle in the cell's set that the image may show (Frustum).
std::unique_ptr<CullMethod> cullPvsFrustum(const DrawScene& scene, const PvsUnits& units,
                                           const CellChoice& choice);

/// The cell from frame to frame: where it is the camera's, PvsUnits::cellAt with the last one as hint.
class CameraCell {
 public:
  CameraCell(const PvsUnits& units, const CellChoice& choice) : units_(units), choice_(choice) {}

  /// The cell to draw; nothing: draw all. counts.outside says whether the camera is in no cell. number: of
  /// the frame.
  std::optional<uint32_t> find(const Camera& camera, uint64_t number, FrameCounts& counts);
  void forget() { last_.reset(); }

 private:
  const PvsUnits& units_;
  CellChoice choice_;
  std::optional<uint32_t> last_;
};

}  // namespace sightline

#pragma once
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "core/picture/picture.h"
#include "core/scene/scene.h"

namespace sightline {

/// A perspective camera. right, up and forward are unit vectors.
struct PictureCamera {
  glm::dvec3 position{0};
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
  double tan_x = 1, tan_y = 1;  ///< half of the picture's width and height at distance 1

  /// Direction, not normalised (its part along forward is 1), through a place of the picture; 0..1 from the
  /// upper left corner.
  glm::dvec3 direction(double x, double y) const;
  /// x, y: place in the picture, 0..1 (outside it too); z: distance along forward, not positive behind.
  glm::dvec3 project(const glm::dvec3& point) const;
};

/// What the view from outside shows, and from where.
struct OutsideView {
  PictureCamera camera;
  std::optional<float> cut_height;  ///< nothing above it is drawn
};

/// Moves the start of a camera ray down to the cut; a zero direction where it never gets there.
Ray cutRay(const glm::dvec3& origin, const glm::dvec3& direction, const std::optional<float>& cut_height);

/// Fits the neighbourhood of cell and PVS, cuts the scene open where asked, and takes the side, of 8, that
/// shows most of the PVS and does not hide the cell. member: as of membership.
OutsideView placeOutsideView(const TraceRays& trace, const Scene& scene, const CellPvs& pvs,
                             std::span<const uint8_t> member, const PictureOptions& options);

/// The camera that shows all of these bounds, along none of their sides.
OutsideView placeWholeView(const Bounds& bounds, const PictureOptions& options);

}  // namespace sightline

#pragma once
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "core/shared/types.h"

namespace sightline {

/// A box (or rectangle) from which visibility is computed. As in the cells file:
/// {"cells":[{"name":"street-1","center":[x,y,z],"size":[w,h,d],"rotation":[rx,ry,rz]}]}
struct ViewCell {
  std::string name;          ///< unique in its file, not empty
  glm::dvec3 center{0.0};    ///< world space
  glm::dvec3 size{0.0};      ///< full extents along the local axes, >= 0, at most one of them zero
  glm::dvec3 rotation{0.0};  ///< degrees about x, then y, then z

  /// With size.z == 0 the cell is a rectangle in its local xy plane that looks along local +z only. With
  /// size.x or size.y zero it is a sheet that looks to both sides.
  bool flat() const { return size.z == 0.0; }

  bool operator==(const ViewCell&) const = default;
};

/// The cells, each moved by as much: from a file's coordinates to those of a scene with an offset
/// (Scene::offset), or back.
ViewCell moved(ViewCell cell, const glm::dvec3& by);
std::vector<ViewCell> moved(std::vector<ViewCell> cells, const glm::dvec3& by);

/// The rectangles from which rays leave: one for a flat cell, else those of the six with an area, in the
/// order -x, +x, -y, +y, -z, +z of the local axes.
std::vector<Face> cellFaces(const ViewCell& cell);

/// World-space corners of the cell, 8 of them (pairs coincide along an axis of size zero).
std::vector<glm::vec3> cellCorners(const ViewCell& cell);

}  // namespace sightline

#pragma once
#include <glm/glm.hpp>

#include "core/cell/view_cell.h"

namespace sightline {

struct CellFrame;

/// Whether a position (world space) lies in the cell: inside of it or on its surface, as the rays of a bake
/// leave it. Those faces are rounded to float, so the box is grown by as much as their corners stray from the
/// exact cell: nothing where floats hold the corners, else some units in the last place of a float. Thus
/// between two cells that share a face no position is lost, and one on the face lies in both.
/// A rectangle or sheet (an extent of 0) holds the positions on it. NaN and infinity: false.
bool cellContains(const ViewCell& cell, const glm::dvec3& position);

/// How far, along each local axis, the corners of the faces in float lie from those of the exact box.
/// frame: of this cell.
glm::dvec3 roundingOfFaces(const ViewCell& cell, const CellFrame& frame);

}  // namespace sightline

#pragma once
#include <span>
#include <vector>

#include "core/cell/view_cell.h"
#include "core/picture/outside_camera.h"
#include "core/picture/png.h"

namespace sightline {

/// Draws a view cell over a finished picture: clear faces, sharp edges, both fainter where the scene hides
/// them, an arrow along a flat cell's normal, and a ring around a cell too small to be found otherwise.
/// depths: of the scene along the camera's forward axis, one a pixel, infinity where there is none.
void drawCell(Image& image, std::span<const float> depths, const PictureCamera& camera, const ViewCell& cell);

/// Draws a ring of the given radius, in pixels, around a pixel's centre.
void drawRing(Image& image, double x, double y, double radius, double line_width, Rgb color);

}  // namespace sightline

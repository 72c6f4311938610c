// The rays of square pinhole images, and the order in which their pixels are traced.
#ifndef SL_VIEW_RAY_H
#define SL_VIEW_RAY_H
#include "core/shared/types.h"
#include "core/shared/vector.h"
SL_NAMESPACE_BEGIN

/// Where an image is taken from and what it shows: the point forward + a * right + b * up, a and b in
/// [-1, 1], is in the image; right and up are scaled by the tangent of half the field of view.
///
///        +-----------+  up        rows from top to bottom, row 0 near b = 1;
///        |     ^     |            columns from left to right, column 0 near a = -1
///        |     o-->  |  right
///        |           |
///        +-----------+
SL_STRUCT(ViewFrame) {
  vec4 origin;   ///< xyz; w = 0
  vec4 forward;  ///< unit vector
  vec4 right;
  vec4 up;
};

/// The ray through the centre of pixel (x, y) of an image of resolution * resolution pixels, up to 2^23 a
/// side. Its direction is as long as `resolution` straight ahead: no division, so no rounding of one.
SL_FUNC Ray viewRay(ViewFrame frame, uint x, uint y, uint resolution) {
  float across = slFloat(2u * x + 1u) - slFloat(resolution);
  float along = slFloat(resolution) - slFloat(2u * y + 1u);
  vec3 direction = scale3(xyz3(frame.forward), slFloat(resolution));
  direction = add3(direction, scale3(xyz3(frame.right), across));
  direction = add3(direction, scale3(xyz3(frame.up), along));
  Ray ray;
  ray.origin = frame.origin;
  ray.direction = vec4(direction.x, direction.y, direction.z, 0.0f);
  return ray;
}

// Images are traced tile by tile: work items 0 .. viewItems - 1 of an image, 32 a tile of 8 by 4 pixels (a
// group of a GPU that runs in step), and of these 8 a half tile of 4 by 2 (a packet of a CPU).
SL_CONST uint kViewTileWidth = 8u;
SL_CONST uint kViewTileHeight = 4u;
SL_CONST uint kViewTileItems = 32u;

/// Work items of one image, those beyond its right and lower edge included. resolution: up to 16,384.
SL_FUNC uint viewItems(uint resolution) {
  uint columns = (resolution + (kViewTileWidth - 1u)) / kViewTileWidth;
  uint rows = (resolution + (kViewTileHeight - 1u)) / kViewTileHeight;
  return columns * rows * kViewTileItems;
}

/// Number of the pixel (row by row) of an image's work item; kNoTriangle beyond the edge.
SL_FUNC uint viewPixel(uint item, uint resolution) {
  uint columns = (resolution + (kViewTileWidth - 1u)) / kViewTileWidth;
  uint tile = item / kViewTileItems;
  uint lane = item % kViewTileItems;
  uint tile_y = tile / columns;
  uint tile_x = tile - tile_y * columns;
  // Bits of the lane: y1 x2 y0 x1 x0.
  uint x = tile_x * kViewTileWidth + ((lane & 3u) | ((lane >> 1u) & 4u));
  uint y = tile_y * kViewTileHeight + (((lane >> 2u) & 1u) | ((lane >> 3u) & 2u));
  return x < resolution && y < resolution ? y * resolution + x : kNoTriangle;
}

SL_NAMESPACE_END
#endif

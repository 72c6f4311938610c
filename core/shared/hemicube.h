// Hemicubes: what is seen from a point of a view cell's face (Nirenstein and Blake 2004; thesis 7.1), as five
// square images of 90 degrees: the front along the face's normal, and four sides of which only the half in
// front of the face counts.
//
//            +-------+
//            |  +v   |          the upper half of each side, towards the normal
//    +-------+-------+-------+
//    |  -u   | front |  +u   |
//    +-------+-------+-------+
//            |  -v   |
//            +-------+
//
// A sample is a pixel that counts: all of the front, then the upper rows of the sides in the order +u, -u,
// +v, -v.
#ifndef SL_HEMICUBE_H
#define SL_HEMICUBE_H
#include "core/shared/types.h"
SL_NAMESPACE_BEGIN

SL_CONST uint kHemicubeViews = 5u;

/// Samples of a hemicube of resolution * resolution pixels an image; resolution: up to 16,384. The middle row
/// of an odd number looks along the face and does not count.
SL_FUNC uint hemicubeSamples(uint resolution) {
  return resolution * resolution + 4u * (resolution * (resolution / 2u));
}

/// View (0 .. 4) of a sample.
SL_FUNC uint hemicubeView(uint place, uint resolution) {
  uint front = resolution * resolution;
  return place < front ? 0u : 1u + (place - front) / (resolution * (resolution / 2u));
}

/// Number of a sample's pixel in its image, row by row from the top.
SL_FUNC uint hemicubePixel(uint place, uint resolution) {
  uint front = resolution * resolution;
  return place < front ? place : (place - front) % (resolution * (resolution / 2u));
}

SL_NAMESPACE_END
#endif

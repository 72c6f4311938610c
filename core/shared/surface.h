// What a ray does at a triangle that does not simply end it on both sides: the holes of alpha masks, glass
// that is seen and seen through, and triangles that only their front shows.
//
// A triangle has a surface word: 0 is opaque from both sides; else flags, and of a masked one the index of
// its MaskedTriangle. All surfaces of a scene lie in one array of words, for a device has one address for
// them:
//
//   0: where the MaskedTriangles begin   1: where the AlphaMasks begin   2: where the texels begin   3:
//   unused 4 ...: the surface words, in the order of the triangles in the tree's leaves; then the three parts
//
// Triangles of a mesh that is shown in many places have their word once, and so the same surface in each.
//
// Which texel a ray meets is decided in whole numbers. The edge functions of the sheared corners
// (triangle.h), in double, give the shares of the second and third corner as floats, which are cut to
// multiples of 2^-24; the corners' places in the image are whole numbers too (fractions of a texel); so the
// texel is a floor of integers. It is the one at a point of the triangle that lies within 2^-23 of its
// extent, in the image, of the point where the ray meets the triangle that intersectTriangle tested. In float
// alone the shares of triangles that are seen at a flat angle would be off by many texels.
#ifndef SL_SURFACE_H
#define SL_SURFACE_H
#include "core/shared/triangle.h"
SL_NAMESPACE_BEGIN

SL_CONST uint kSurfaceMasked = 0x80000000u;     ///< has holes
SL_CONST uint kSurfaceGlass = 0x40000000u;      ///< seen, and seen through
SL_CONST uint kSurfaceFrontOnly = 0x20000000u;  ///< not there from behind
SL_CONST uint kSurfaceIndex = 0x1fffffffu;      ///< of the MaskedTriangle

SL_CONST uint kSurfaceHeaderWords = 4u;
SL_CONST uint kMaskedTriangleWords = 8u;
SL_CONST uint kAlphaMaskWords = 4u;

/// How an image goes on beyond its edge.
SL_CONST uint kWrapRepeat = 0u;
SL_CONST uint kWrapMirror = 1u;
SL_CONST uint kWrapClamp = 2u;

/// Places in the image are offset by this many of their units, so that they are not negative.
SL_CONST uint kTexelOffset = 0x40000000u;
/// Bits behind the point of a corner's share.
SL_CONST uint kShareBits = 24u;

/// Where the corners of a masked triangle lie in the image of its mask, in 2^-fraction_bits texels, each plus
/// kTexelOffset and below 2 * kTexelOffset; x to the right, y down. Where the image repeats, no corner is
/// negative without the offset.
SL_STRUCT(MaskedTriangle) {
  uvec4 corners_ab;     ///< x, y of the first; x, y of the second
  uvec4 corner_c_mask;  ///< x, y of the third; index of the AlphaMask; fraction_bits, 0 .. 16
};

/// An image of which each texel holds or is a hole: a bit each, row after row, from the lowest bit of a word.
SL_STRUCT(AlphaMask) {
  uvec4 size_wrap_first;  ///< width, height (1 .. 2^16); wrap of x + 4 * wrap of y; first word of the texels
};

/// Shares of the second and third corner where the ray passes a triangle, 0 .. 1; and which side it meets.
SL_STRUCT(Passage) {
  float share_b;
  float share_c;
  bool front;
};

/// For a ray that intersectTriangle says hits the triangle with these corners.
SL_FUNC Passage passageOf(ShearedRay ray, vec3 v0, vec3 v1, vec3 v2) {
  PreciseEdges edges = preciseEdges(shearVertex(ray, v0), shearVertex(ray, v1), shearVertex(ray, v2));
  Passage result;
#if SL_FP64
  result.share_b = slFloat(slDivide(edges.v, edges.det));
  result.share_c = slFloat(slDivide(edges.w, edges.det));
  bool positive = edges.det > 0.0;
#else
  result.share_b = divideTwoFloats(edges.v, edges.det);
  result.share_c = divideTwoFloats(edges.w, edges.det);
  bool positive = edges.det.high > 0.0f;
#endif
  // det is minus the doubled area on the plane across the depth axis, counter-clockwise positive; the front
  // is counter-clockwise for who looks against that axis, as rays do whose direction along it is negative.
  result.front = positive == (ray.shear.z > 0.0f);
  return result;
}

/// The texel of an axis in an image of so many, after wrapping.
SL_FUNC uint wrappedTexel(int texel, uint size, uint wrap) {
  if (wrap == kWrapClamp) return slUint(min(max(texel, 0), slInt(size) - 1));
  uint place = slUint(max(texel, 0));
  if (wrap == kWrapRepeat) return place % size;
  place = place % (2u * size);
  return place < size ? place : 2u * size - 1u - place;
}

/// The texel along an axis, before wrapping, of shares that add up to 2^kShareBits.
SL_FUNC int texelAt(uint a, uint b, uint c, uint share_a, uint share_b, uint share_c, uint fraction_bits) {
  uint64 place =
      slUint64(a) * slUint64(share_a) + slUint64(b) * slUint64(share_b) + slUint64(c) * slUint64(share_c);
  return slInt(slUint(place >> (kShareBits + fraction_bits))) - slInt(kTexelOffset >> fraction_bits);
}

/// Whether the masked triangle `index` holds at these shares of its corners. mirrored: where it is shown, its
/// second and third corner have changed places (core/shared/placement.h).
SL_FUNC bool placedMaskHolds(SL_SURFACES_PARAM, uint index, float second, float third, bool mirrored) {
  uint t = SL_SURFACE_WORD(0u) + index * kMaskedTriangleWords;
  uint b = t + (mirrored ? 4u : 2u);
  uint c = t + (mirrored ? 2u : 4u);
  uint mask = SL_SURFACE_WORD(1u) + SL_SURFACE_WORD(t + 6u) * kAlphaMaskWords;
  uint bits = SL_SURFACE_WORD(t + 7u);
  uint share_b = min(slUint(max(second, 0.0f) * 16777216.0f), 1u << kShareBits);
  uint share_c = min(slUint(max(third, 0.0f) * 16777216.0f), (1u << kShareBits) - share_b);
  uint share_a = (1u << kShareBits) - share_b - share_c;
  int x =
      texelAt(SL_SURFACE_WORD(t), SL_SURFACE_WORD(b), SL_SURFACE_WORD(c), share_a, share_b, share_c, bits);
  int y = texelAt(SL_SURFACE_WORD(t + 1u), SL_SURFACE_WORD(b + 1u), SL_SURFACE_WORD(c + 1u), share_a, share_b,
                  share_c, bits);
  uint width = SL_SURFACE_WORD(mask);
  uint wrap = SL_SURFACE_WORD(mask + 2u);
  uint column = wrappedTexel(x, width, wrap & 3u);
  uint row = wrappedTexel(y, SL_SURFACE_WORD(mask + 1u), wrap >> 2u);
  uint bit = row * width + column;
  return ((SL_SURFACE_WORD(SL_SURFACE_WORD(2u) + SL_SURFACE_WORD(mask + 3u) + (bit >> 5u)) >> (bit & 31u)) &
          1u) != 0u;
}

SL_FUNC bool maskHolds(SL_SURFACES_PARAM, uint index, float second, float third) {
  return placedMaskHolds(SL_SURFACES, index, second, third, false);
}

/// Whether a ray that intersectTriangle says hits the triangle meets something there: not a hole, not the
/// back of what has only a front. The corners are those in the world; mirrored: as of placedMaskHolds.
SL_FUNC bool placedSurfaceHolds(SL_SURFACES_PARAM, uint surface, ShearedRay ray, vec3 v0, vec3 v1, vec3 v2,
                                bool mirrored) {
  if ((surface & (kSurfaceMasked | kSurfaceFrontOnly)) == 0u) return true;
  Passage passage = passageOf(ray, v0, v1, v2);
  if ((surface & kSurfaceFrontOnly) != 0u && !passage.front) return false;
  return (surface & kSurfaceMasked) == 0u ||
         placedMaskHolds(SL_SURFACES, surface & kSurfaceIndex, passage.share_b, passage.share_c, mirrored);
}

SL_FUNC bool surfaceHolds(SL_SURFACES_PARAM, uint surface, ShearedRay ray, vec3 v0, vec3 v1, vec3 v2) {
  return placedSurfaceHolds(SL_SURFACES, surface, ray, v0, v1, v2, false);
}

SL_NAMESPACE_END
#endif

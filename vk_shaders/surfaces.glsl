// What a ray does at a leaf with a surface, and what becomes of the glass that it meets. Answers depend on ray and leaf
// alone, and what is done twice is as if done once: drivers ask in any order, and about one triangle perhaps often.
#ifndef SL_SURFACES_GLSL
#define SL_SURFACES_GLSL
#include "vk_shaders/state.glsl"

uint surfaceOfLeaf(uint leaf) {
  return SL_SURFACE_WORD(kSurfaceHeaderWords + leaf);
}

bool isGlass(uint leaf) {
  return (surfaceOfLeaf(leaf) & kSurfaceGlass) != 0u;
}

/// Whether a ray that the driver says hits the leaf's triangle in a part meets something there.
bool leafHolds(Ray ray, uint leaf, uint part) {
  Corners v = Corners(leafCorner(leaf, 0u), leafCorner(leaf, 1u), leafCorner(leaf, 2u));
  uint place = SL_THE_LAUNCH.instance_count == 0u ? kNoTriangle : Buffer_uint(SL_THE_LAUNCH.part_places).at[part];
  bool mirrored = false;
  if (place != kNoTriangle) {
    InstanceRecord instance = Buffer_InstanceRecord(SL_THE_LAUNCH.instances).at[place];
    v = placeCorners(instance.place, instance.roots.z, v.a, v.b, v.c);
    mirrored = (instance.roots.z & kInstanceMirrors) != 0u;
  }
  return placedSurfaceHolds(kTheSurfaces, surfaceOfLeaf(leaf), shearRay(ray), v.a, v.b, v.c, mirrored);
}

#if SL_HAS_GLASS
/// What becomes of glass that a ray meets: into the set under the ray's index, whether the set lacks any, or ray and
/// triangle into `indices`, as many as list_end.
const uint kInsertGlass = 0u;
const uint kTestGlass = 1u;
const uint kListGlass = 2u;

/// true: the set lacks the triangle.
bool visitGlass(uint action, uint index, uint triangle) {
  if (action == kTestGlass) return !isInSet(kTheSet, triangle);
  if (action == kInsertGlass) {
    insertHit(kTheSet, triangle, index);
    return false;
  }
  uint place = SL_STAGE_ADD(counters, kListCounter, 1u);
  if (place < SL_LAUNCH(list_end)) {
    SL_BUFFER(indices, 2u * place) = index;
    SL_BUFFER(indices, 2u * place + 1u) = triangle;
  }
  return false;
}

/// Of a walk over glass that the driver says the ray meets in a leaf at t: visits it if it is no farther than the
/// walk's end and holds. true: the set lacks it.
bool visitLeaf(uint action, uint index, Ray ray, uint leaf, uint part, float t, float end) {
  return isGlass(leaf) && t <= end && leafHolds(ray, leaf, part) && visitGlass(action, index, idOfLeaf(leaf, part));
}
#endif

#endif

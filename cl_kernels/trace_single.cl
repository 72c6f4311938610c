// One ray through the 2-wide tree: the way of GPUs, where a work item is a ray.
//
// Based on: Aila, Laine, Understanding the Efficiency of Ray Traversal on GPUs, HPG 2009 ("speculative
// while-while"): a ray that comes to a leaf goes on through inner nodes until it meets a second one, so that
// the rays of a group that run in step intersect triangles together. Which hit is nearest does not depend on
// the order (core/shared/triangle.h).
#include "cl_kernels/scene.cl"

/// What a hit on the triangle of a record counts for: the best hit, if it is nearer, or as near with a lower id.
/// place: of the record; v: its corners in the world; bits: kInstance... of what placed them. glass: set where the ray
/// meets glass before the best hit so far.
static inline void intersectCorners(SceneRef scene, uint place, Corners v, uint bits, uint id, ShearedRay ray, Hit* best,
                                    bool* glass) {
  const float t = intersectTriangle(ray, v.a, v.b, v.c);
#if SL_HAS_SURFACES
  if (!(t > 0.0f && t <= best->t)) return;
  const uint surface = scene.surfaces[kSurfaceHeaderWords + place];
  if ((surface & kSurfaceGlass) != 0) {
    *glass = true;
    return;
  }
  if (t == best->t && id >= best->triangle) return;
  if (!placedSurfaceHolds(scene.surfaces, surface, ray, v.a, v.b, v.c, (bits & kInstanceMirrors) != 0)) return;
#else
  if (!(t > 0.0f && (t < best->t || (t == best->t && id < best->triangle)))) return;
#endif
  best->t = t;
  best->triangle = id;
}

/// Where a walk goes on: an inner node by its index, or a leaf in a word (core/shared/bvh_node.h).
#define SL_NO_LEAF 0u
#define SL_WALK_END 0xffffffffu

static inline bool isLeaf(uint place) {
  return (place & kLeafBit) != 0 && place != SL_WALK_END;
}

static inline uint placeOfChild(const BvhNode2* node, uint i) {
  if (node->count[i] == 0) return node->child[i];
  return kLeafBit | (node->count[i] - 1) << kLeafCountShift | node->child[i];
}

/// Takes the last place off the stack that may have a hit as near as t. x: bits of the distance, y: place; at
/// the bottom lies the end of the walk.
static inline uint popPlace(const uint2* stack, uint* size, float t) {
  uint2 entry;
  do {
    entry = stack[--*size];
  } while (as_float(entry.x) > t);
  return entry.y;
}

static inline void intersectLeaf(SceneRef scene, uint leaf, ShearedRay ray, Hit* best, bool* glass) {
  const uint first = leaf & kLeafFirstMask;
  const uint count = (leaf >> kLeafCountShift & 7u) + 1;
  for (uint i = 0; i < count; ++i) {
    __global const SceneTriangle* record = &scene.triangles[first + i];
    intersectCorners(scene, first + i, recordCorners(record), 0u, recordId(record), ray, best, glass);
  }
}

/// Which of a node's children the ray goes on to; the other one waits on the stack, if the ray meets both.
static inline uint descend(SceneRef scene, uint place, BoxRay box_ray, float t, uint2* stack, uint* size) {
  const BvhNode2 node = scene.nodes[place];
  const float2 range0 =
      intersectBox(box_ray, vec3(node.x.x, node.y.x, node.z.x), vec3(node.x.y, node.y.y, node.z.y));
  const float2 range1 =
      intersectBox(box_ray, vec3(node.x.z, node.y.z, node.z.z), vec3(node.x.w, node.y.w, node.z.w));
  const bool meets0 = range0.x <= min(range0.y, t);
  const bool meets1 = range1.x <= min(range1.y, t);
  const uint place0 = placeOfChild(&node, 0);
  const uint place1 = placeOfChild(&node, 1);
  if (meets0 && meets1) {
    const bool swap = range1.x < range0.x;
    stack[(*size)++] = swap ? (uint2)(as_uint(range0.x), place0) : (uint2)(as_uint(range1.x), place1);
    return swap ? place1 : place0;
  }
  if (meets0 || meets1) return meets0 ? place0 : place1;
  return popPlace(stack, size, t);
}

#if SL_INSTANCES
#include "cl_kernels/single_instance.cl"
#else
/// glass: set where the ray meets glass before what ends it, and perhaps where only behind.
static Hit traceRay(SceneRef scene, Ray ray, bool* glass) {
  Hit best = missHit();
  if (!hasDirection(ray)) return best;
  const BoxRay box_ray = boxRay(ray, scene.reach);
  const ShearedRay sheared = shearRay(ray);
  uint2 stack[SL_MAX_DEPTH + 1];
  stack[0] = (uint2)(0u, SL_WALK_END);
  uint size = 1;
  uint place = 0;
  uint leaf = SL_NO_LEAF;  // waits for its triangles to be intersected
  while (place != SL_WALK_END) {
    while ((place & kLeafBit) == 0) {
      place = descend(scene, place, box_ray, best.t, stack, &size);
      if (isLeaf(place) && leaf == SL_NO_LEAF) {
        leaf = place;
        place = popPlace(stack, &size, best.t);
      }
    }
    while (leaf != SL_NO_LEAF) {
      intersectLeaf(scene, leaf, sheared, &best, glass);
      leaf = SL_NO_LEAF;
      if (isLeaf(place)) {
        leaf = place;
        place = popPlace(stack, &size, best.t);
      }
    }
  }
  return best;
}
#endif

// One ray through the 2-wide tree: the way of GPUs, where a work item is a ray.
//
// Based on: Aila, Laine, Understanding the Efficiency of Ray Traversal on GPUs, HPG 2009 ("speculative
// while-while"): a ray that comes to a leaf goes on through inner nodes until it meets a second one, so that
// the rays of a group that run in step intersect triangles together. Which hit is nearest does not depend on
// the order (core/shared/triangle.h).
#include "cl_kernels/scene.cl"

static inline Corners recordCorners(__global const SceneTriangle* record) {
  Corners corners;
#if SL_PACKET > 1
  __global const float* v = record->vertices;
  corners.a = vec3(v[0], v[1], v[2]);
  corners.b = vec3(v[3], v[4], v[5]);
  corners.c = vec3(v[6], v[7], v[8]);
#else
  corners.a = record->v0.xyz;
  corners.b = record->v1.xyz;
  corners.c = record->v2.xyz;
#endif
  return corners;
}

static inline uint recordId(__global const SceneTriangle* record) {
#if SL_PACKET > 1
  return record->id;
#else
  return as_uint(record->v0.w);
#endif
}

/// glass: set where the ray meets glass before the best hit so far.
static inline void intersectRecord(SceneRef scene, uint place, ShearedRay ray, Hit* best, bool* glass) {
  const Corners v = recordCorners(&scene.triangles[place]);
  const uint id = recordId(&scene.triangles[place]);
  const float t = intersectTriangle(ray, v.a, v.b, v.c);
#if SL_HAS_SURFACES
  if (!(t > 0.0f && t <= best->t)) return;
  const uint surface = scene.surfaces[kSurfaceHeaderWords + place];
  if ((surface & kSurfaceGlass) != 0) {
    *glass = true;
    return;
  }
  if (t == best->t && id >= best->triangle) return;
  if (!surfaceHolds(scene.surfaces, surface, ray, v.a, v.b, v.c)) return;
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
  for (uint i = 0; i < count; ++i) intersectRecord(scene, first + i, ray, best, glass);
}

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
      const BvhNode2 node = scene.nodes[place];
      const float2 range0 =
          intersectBox(box_ray, vec3(node.x.x, node.y.x, node.z.x), vec3(node.x.y, node.y.y, node.z.y));
      const float2 range1 =
          intersectBox(box_ray, vec3(node.x.z, node.y.z, node.z.z), vec3(node.x.w, node.y.w, node.z.w));
      const bool meets0 = range0.x <= min(range0.y, best.t);
      const bool meets1 = range1.x <= min(range1.y, best.t);
      const uint place0 = placeOfChild(&node, 0);
      const uint place1 = placeOfChild(&node, 1);
      if (meets0 && meets1) {
        const bool swap = range1.x < range0.x;
        stack[size++] = swap ? (uint2)(as_uint(range0.x), place0) : (uint2)(as_uint(range1.x), place1);
        place = swap ? place1 : place0;
      } else if (meets0 || meets1) {
        place = meets0 ? place0 : place1;
      } else {
        place = popPlace(stack, &size, best.t);
      }
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

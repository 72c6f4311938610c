// One ray through two levels, as the other way of trace_single.cl: in one loop, so that the rays of a group that run in
// step need not be on the same level. On the stack a mark stands below what belongs to an instance.

/// The walk leaves an instance.
#define SL_WALK_LEAVE 0xfffffffeu

static inline bool isLeafOfEither(uint place) {
  return isLeaf(place) && place != SL_WALK_LEAVE;
}

static inline void intersectLeafIn(SceneRef scene, __global const InstanceRecord* instance, uint leaf, ShearedRay ray,
                                   Hit* best, bool* glass) {
  if ((instance->roots.z & kInstanceInPlace) != 0) {
    intersectLeaf(scene, leaf, ray, best, glass);
    return;
  }
  const uint first = leaf & kLeafFirstMask;
  const uint count = (leaf >> kLeafCountShift & 7u) + 1;
  for (uint i = 0; i < count; ++i) {
    __global const SceneTriangle* record = &scene.triangles[first + i];
    intersectCorners(scene, first + i, placedCorners(instance, record), instance->roots.z,
                     instance->ids.x + recordId(record), ray, best, glass);
  }
}

/// What the boxes of the instance's mesh are tested with.
static inline BoxRay boxRayIn(SceneRef scene, __global const InstanceRecord* instance, Ray ray) {
  if ((instance->roots.z & kInstanceInPlace) != 0) return boxRay(ray, scene.reach);
  const InstanceRecord copy = *instance;
  return instanceBoxRay(copy, ray, localRay(copy, ray), scene.reach);
}

/// glass: as of the other traceRay.
static Hit traceRay(SceneRef scene, Ray ray, bool* glass) {
  Hit best = missHit();
  if (!hasDirection(ray)) return best;
  const ShearedRay sheared = shearRay(ray);
  BoxRay box_ray = boxRay(ray, scene.reach);
  __global const InstanceRecord* inside = 0;
  uint2 stack[2 * SL_MAX_DEPTH + 2];
  stack[0] = (uint2)(0u, SL_WALK_END);
  uint size = 1;
  uint place = scene.root;
  uint leaf = SL_NO_LEAF;  // waits for its triangles to be intersected
  while (place != SL_WALK_END) {
    while ((place & kLeafBit) == 0) {
      place = descend(scene, place, box_ray, best.t, stack, &size);
      if (inside == 0) break;
      if (isLeafOfEither(place) && leaf == SL_NO_LEAF) {
        leaf = place;
        place = popPlace(stack, &size, best.t);
      }
    }
    while (inside != 0 && leaf != SL_NO_LEAF) {
      intersectLeafIn(scene, inside, leaf, sheared, &best, glass);
      leaf = SL_NO_LEAF;
      if (isLeafOfEither(place)) {
        leaf = place;
        place = popPlace(stack, &size, best.t);
      }
    }
    if (place == SL_WALK_LEAVE) {
      inside = 0;
      box_ray = boxRay(ray, scene.reach);
      place = popPlace(stack, &size, best.t);
    }
    if (inside == 0 && isLeafOfEither(place)) {
      inside = &scene.instances[scene.instance_order[place & kLeafFirstMask]];
      box_ray = boxRayIn(scene, inside, ray);
      stack[size++] = (uint2)(0u, SL_WALK_LEAVE);
      place = inside->roots.x;
    }
  }
  return best;
}

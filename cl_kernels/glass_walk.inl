// One ray through all of a 2-wide tree up to its end. Included for each kind of leaves: SL_WALK names the function,
// SL_VISIT(i) says of each place i of a leaf whether the set lacks what is there, SL_WALK_PARAM are further parameters.
static bool SL_WALK(const StageRef* stage, GlassVisit visit, uint root, BoxRay box_ray, ShearedRay ray,
                    float end SL_WALK_PARAM) {
  uint stack[SL_MAX_DEPTH + 1];
  uint size = 0;
  uint place = root;
  bool lacks = false;
  for (;;) {
    const BvhNode2 node = stage->scene.nodes[place];
    uint next = kNoTriangle;
    for (uint i = 0; i < 2; ++i) {
      const float2 range =
          i == 0 ? intersectBox(box_ray, vec3(node.x.x, node.y.x, node.z.x), vec3(node.x.y, node.y.y, node.z.y))
                 : intersectBox(box_ray, vec3(node.x.z, node.y.z, node.z.z), vec3(node.x.w, node.y.w, node.z.w));
      if (!(range.x <= min(range.y, end)) || node.child[i] == kNoTriangle) continue;
      if (node.count[i] > 0) {
        for (uint k = node.child[i]; k < node.child[i] + node.count[i]; ++k) lacks |= SL_VISIT(k);
      } else if (next == kNoTriangle) {
        next = node.child[i];
      } else {
        stack[size++] = node.child[i];
      }
    }
    if (next == kNoTriangle) {
      if (size == 0) return lacks;
      next = stack[--size];
    }
    place = next;
  }
}

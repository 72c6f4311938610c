// Visits a tree with all lanes of a packet; lanes with t < 0 take no part. Included for each kind of leaves: SL_WALK
// names the function, SL_VISIT(i) is done for each place i of a leaf, SL_WALK_PARAM are further parameters.
static void SL_WALK(SceneRef scene, uint root, Packet* p SL_WALK_PARAM) {
  float8 stack_near[SL_MAX_DEPTH];
  uint stack_child[SL_MAX_DEPTH];
  uint stack_count[SL_MAX_DEPTH];
  uint size = 0;
  uint child = root;
  uint count = 0;
  // Where a node keeps the planes that the rays meet first and last, in floats; child 1 has them two further.
  const size_t back_x = p->back_x, ahead_x = 1 - back_x;
  const size_t back_y = 4 + p->back_y, ahead_y = 5 - p->back_y;
  const size_t back_z = 8 + p->back_z, ahead_z = 9 - p->back_z;
  for (;;) {
    while (count == 0) {
      __global const float* node = (__global const float*)&scene.nodes[child];
      __global const uint* links = (__global const uint*)(node + 12);
      __global const float* first_x = node + back_x;
      __global const float* first_y = node + back_y;
      __global const float* first_z = node + back_z;
      __global const float* last_x = node + ahead_x;
      __global const float* last_y = node + ahead_y;
      __global const float* last_z = node + ahead_z;
      float8 near0 =
          most(most(slab(first_x[0], p->inverse_x, p->near_x), slab(first_y[0], p->inverse_y, p->near_y)),
               most(slab(first_z[0], p->inverse_z, p->near_z), (float8)0.0f));
      float8 far0 =
          least(least(slab(last_x[0], p->inverse_x, p->far_x), slab(last_y[0], p->inverse_y, p->far_y)),
                least(slab(last_z[0], p->inverse_z, p->far_z), p->t));
      float8 near1 =
          most(most(slab(first_x[2], p->inverse_x, p->near_x), slab(first_y[2], p->inverse_y, p->near_y)),
               most(slab(first_z[2], p->inverse_z, p->near_z), (float8)0.0f));
      float8 far1 =
          least(least(slab(last_x[2], p->inverse_x, p->far_x), slab(last_y[2], p->inverse_y, p->far_y)),
                least(slab(last_z[2], p->inverse_z, p->far_z), p->t));
      uint meets0 = laneBits(near0 <= far0);
      uint meets1 = laneBits(near1 <= far1);
      if (meets0 != 0 && meets1 != 0) {
        // First the child that most lanes of both enter first.
        uint both = meets0 | meets1;
        uint sooner1 = laneBits(near1 < near0) & both;
        bool swap = 2 * popcount(sooner1) > popcount(both);
        stack_near[size] = swap ? near0 : near1;
        size_t first = swap ? 1 : 0;
        stack_child[size] = links[1 - first];
        stack_count[size] = links[3 - first];
        ++size;
        child = links[first];
        count = links[2 + first];
      } else if (meets0 != 0) {
        child = links[0];
        count = links[2];
      } else if (meets1 != 0) {
        child = links[1];
        count = links[3];
      } else {
        break;
      }
    }
    for (uint i = child; i < child + count; ++i) SL_VISIT(i);
    do {
      if (size == 0) return;
      --size;
    } while (laneBits(stack_near[size] <= p->t) == 0);
    child = stack_child[size];
    count = stack_count[size];
  }
}

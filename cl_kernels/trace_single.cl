// One ray through the 2-wide tree: the way of GPUs, where a work item is a ray.
#include "cl_kernels/scene.cl"

static inline void intersectRecord(__global const TriangleRecord* record, ShearedRay ray, Hit* best) {
#if SL_PACKET > 1
  __global const float* v = record->vertices;
  float t = intersectTriangle(ray, vec3(v[0], v[1], v[2]), vec3(v[3], v[4], v[5]), vec3(v[6], v[7], v[8]));
  uint id = record->id;
#else
  float4 v0 = record->v0;
  float t = intersectTriangle(ray, v0.xyz, record->v1.xyz, record->v2.xyz);
  uint id = as_uint(v0.w);
#endif
  if (t > 0.0f && (t < best->t || (t == best->t && id < best->triangle))) {
    best->t = t;
    best->triangle = id;
  }
}

static Hit traceRay(SceneRef scene, Ray ray) {
  Hit best = missHit();
  if (!hasDirection(ray)) return best;
  BoxRay box_ray = boxRay(ray, scene.reach);
  ShearedRay sheared = shearRay(ray);
  uint2 stack[SL_STACK_SIZE];  // x: bits of the distance, y: node
  uint size = 0;
  uint node_index = 0;
  for (;;) {
    BvhNode2 node = scene.nodes[node_index];
    float2 range0 =
        intersectBox(box_ray, vec3(node.x.x, node.y.x, node.z.x), vec3(node.x.y, node.y.y, node.z.y));
    float2 range1 =
        intersectBox(box_ray, vec3(node.x.z, node.y.z, node.z.z), vec3(node.x.w, node.y.w, node.z.w));
    bool meets0 = range0.x <= min(range0.y, best.t);
    bool meets1 = range1.x <= min(range1.y, best.t);
    if (meets0 && node.count[0] > 0) {
      for (uint i = 0; i < node.count[0]; ++i)
        intersectRecord(&scene.triangles[node.child[0] + i], sheared, &best);
      meets0 = false;
    }
    if (meets1 && node.count[1] > 0) {
      for (uint i = 0; i < node.count[1]; ++i)
        intersectRecord(&scene.triangles[node.child[1] + i], sheared, &best);
      meets1 = false;
    }
    if (meets0 && meets1) {
      bool swap = range1.x < range0.x;
      stack[size++] =
          swap ? (uint2)(as_uint(range0.x), node.child[0]) : (uint2)(as_uint(range1.x), node.child[1]);
      node_index = swap ? node.child[1] : node.child[0];
    } else if (meets0 || meets1) {
      node_index = meets0 ? node.child[0] : node.child[1];
    } else {
      uint2 entry;
      do {
        if (size == 0) return best;
        entry = stack[--size];
      } while (as_float(entry.x) > best.t);
      node_index = entry.y;
    }
  }
}

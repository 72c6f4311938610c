// Eight rays against the triangle of a record: whether they hit it, and whether that counts. Included for each address
// space that vertices lie in: SL_INTERSECT names the function, SL_VERTICES the space. place: of the record; vertices: x,
// y, z of the three, in the world; bits: kInstance... of what placed them.
static inline void SL_INTERSECT(SceneRef scene, uint place, SL_VERTICES const float* vertices, uint bits, uint id,
                                Packet* p) {
  float8 az = vertices[p->axis_z] - p->origin_z;
  float8 ax = (vertices[p->axis_x] - p->origin_x) - p->shear_x * az;
  float8 ay = (vertices[p->axis_y] - p->origin_y) - p->shear_y * az;
  float8 bz = vertices[3 + p->axis_z] - p->origin_z;
  float8 bx = (vertices[3 + p->axis_x] - p->origin_x) - p->shear_x * bz;
  float8 by = (vertices[3 + p->axis_y] - p->origin_y) - p->shear_y * bz;
  float8 cz = vertices[6 + p->axis_z] - p->origin_z;
  float8 cx = (vertices[6 + p->axis_x] - p->origin_x) - p->shear_x * cz;
  float8 cy = (vertices[6 + p->axis_y] - p->origin_y) - p->shear_y * cz;
  float8 u = cx * by - cy * bx;
  float8 v = ax * cy - ay * cx;
  float8 w = bx * ay - by * ax;
  float8 lowest = least(u, least(v, w));
  float8 highest = most(u, most(v, w));
  int8 inside = (lowest >= 0.0f) | (highest <= 0.0f);
  if (laneBits(inside) == 0) return;

  float8 det = u + v + w;
  float8 reach = most(most(most(fabs(ax), fabs(ay)), most(fabs(bx), fabs(by))), most(fabs(cx), fabs(cy)));
  float8 nearest = least(az, least(bz, cz));
  float8 farthest = most(az, most(bz, cz));
  float8 area = fabs(det);
  float8 trusted = area * most(fabs(nearest), fabs(farthest));
  int8 rough = (trusted < most(reach * reach * (farthest - nearest), (float8)kUnderflowGuard)) |
               (area < kUnderflowGuard) | (u == 0.0f) | (v == 0.0f) | (w == 0.0f);
  float8 depth = (u * az + v * bz + w * cz) / det;
  if (laneBits(rough & inside) != 0) {
    float8 precise = preciseDepth8(ax, ay, az, bx, by, bz, cx, cy, cz);
    depth = rough ? precise : depth;
  }
  float8 t = depth * p->shear_z;
  // An infinite t is no hit: p->t starts at infinity, and the id of a miss is the largest.
  int8 closer = (t < p->t) | ((t == p->t) & (id < p->triangle) & (t < as_float(0x7f800000u)));
  int8 hit = inside & (t > 0.0f) & closer;
#if SL_HAS_SURFACES
  const uint near = laneBits(inside & (t > 0.0f) & (t <= p->t));
  if (near == 0) return;
  const uint surface = scene.surfaces[kSurfaceHeaderWords + place];
  if ((surface & kSurfaceGlass) != 0) {
    p->glass |= near;
    return;
  }
  if (surface != 0) {
    Corners corners;
    corners.a = vec3(vertices[0], vertices[1], vertices[2]);
    corners.b = vec3(vertices[3], vertices[4], vertices[5]);
    corners.c = vec3(vertices[6], vertices[7], vertices[8]);
    const uint holding = lanesThatHold(scene, surface, corners, (bits & kInstanceMirrors) != 0, p, laneBits(hit));
    hit = hit & (((int8)(int)holding & (int8)(1, 2, 4, 8, 16, 32, 64, 128)) != 0);
  }
#endif
  p->t = hit ? t : p->t;
  p->triangle = hit ? (uint8)id : p->triangle;
}

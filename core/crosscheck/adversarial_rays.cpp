#include "core/crosscheck/adversarial_rays.h"

#include <cmath>
#include <utility>

#include "core/shared/ray.h"

namespace sightline {
namespace {

/// Triangles looked at for the smallest of them.
constexpr int kSmallestOf = 16;

/// One random ray in the making. A statement draws one number, or several in turn: the order of arguments is
/// the compiler's.
class Maker {
 public:
  Maker(const AdversarialScene& scene, RayRandom& random) : s_(scene), random_(random) {}

  Ray toVertex() {
    const vec3 target = triangle().a;
    return rayTo(startInCell(), target);
  }

  Ray toEdge() {
    const vec3 target = edgePoint(triangle());
    return rayTo(startInCell(), target);
  }

  Ray alongEdge() {
    const Corners t = triangle();
    const float before = random_.pick(4) == 0 ? 0.0f : std::exp2(random_.unit() * 10 - 5);
    return rayAlong(t.a + (t.a - t.b) * before, t.b - t.a);
  }

  Ray alongAxis() {
    const Corners t = triangle();
    const uint32_t kind = random_.pick(4);
    const vec3 target = kind < 2 ? t.a : (kind == 2 ? edgePoint(t) : innerPoint(t));
    const int axis = int(random_.pick(3));
    vec3 origin = target;
    origin[axis] = startInCell()[axis];
    if (origin == target) origin[axis] += s_.reach;
    return rayTo(origin, target);
  }

  Ray grazing() {
    const Corners t = triangle();
    const vec3 target = random_.pick(2) == 0 ? t.a : innerPoint(t);
    const vec3 normal = normalize3(cross3(t.b - t.a, t.c - t.a));
    const vec3 in_plane = normalize3(cross3(normal, random_.point()));
    const float slope = std::exp2(random_.unit() * -20 - 3.3f);  // 1 : 10 to 1 : 10^7
    const vec3 way = in_plane + normal * (random_.pick(2) == 0 ? slope : -slope);
    return rayTo(target - way * (s_.reach * random_.unit()), target);
  }

  Ray fromPlane() {
    const Corners t = triangle();
    const vec3 origin = random_.pick(3) == 0 ? edgePoint(t) : innerPoint(t);
    if (random_.pick(4) > 0) return rayTo(origin, triangle().a);
    const float v = random_.unit() - 0.5f, u = random_.unit() - 0.5f;
    return rayAlong(origin, (t.b - t.a) * u + (t.c - t.a) * v);
  }

  Ray atFarTiny() {
    Corners smallest = triangle();
    for (int i = 1; i < kSmallestOf; ++i) {
      const Corners t = triangle();
      if (sizeOf(t) < sizeOf(smallest)) smallest = t;
    }
    const vec3 way = normalize3(smallest.a - startInCell());
    return rayTo(smallest.a - way * (s_.reach * std::exp2(random_.unit() * 16)), smallest.a);
  }

 private:
  struct Corners {
    vec3 a, b, c;
  };

  static Ray rayAlong(vec3 origin, vec3 direction) { return {vec4(origin, 0), vec4(direction, 0)}; }
  static float sizeOf(const Corners& t) {
    return std::max(maxAbs3(t.b - t.a), std::max(maxAbs3(t.c - t.a), maxAbs3(t.c - t.b)));
  }

  /// One that can be seen, three times of four; from any of its corners.
  Corners triangle() {
    const bool seen = !s_.visible.empty() && random_.pick(4) > 0;
    const uint32_t id = seen ? s_.visible[random_.pick(s_.visible.size())].origin_triangle.w
                             : random_.pick(s_.scene.triangleCount());
    const auto t = s_.scene.corners(id);
    const int first = int(random_.pick(3));
    const auto corner = [&](int i) { return t[size_t(first + i) % 3]; };
    return {corner(0), corner(1), corner(2)};
  }

  /// On the faces, a quarter of the time at a corner.
  vec3 startInCell() {
    const Face& face = s_.faces[random_.pick(s_.faces.size())];
    const bool corner = random_.pick(4) == 0;
    const float u = corner ? float(random_.pick(2)) : random_.unit();
    const float v = corner ? float(random_.pick(2)) : random_.unit();
    return vec3(face.corner) + vec3(face.edge_u) * u + vec3(face.edge_v) * v;
  }

  vec3 edgePoint(const Corners& t) {
    return random_.pick(4) == 0 ? (t.a + t.b) * 0.5f : glm::mix(t.a, t.b, random_.unit());
  }
  vec3 innerPoint(const Corners& t) {
    const float share = random_.unit();
    return glm::mix(edgePoint(t), t.c, share);
  }

  const AdversarialScene& s_;
  RayRandom& random_;
};

}  // namespace

Ray adversarialRay(RayKind kind, const AdversarialScene& scene, RayRandom& random) {
  Maker maker(scene, random);
  switch (kind) {
    case RayKind::kVertex:
      return maker.toVertex();
    case RayKind::kEdge:
      return maker.toEdge();
    case RayKind::kAlongEdge:
      return maker.alongEdge();
    case RayKind::kAxis:
      return maker.alongAxis();
    case RayKind::kGrazing:
      return maker.grazing();
    case RayKind::kPlane:
      return maker.fromPlane();
    case RayKind::kFarTiny:
      return maker.atFarTiny();
    default:
      return noRay();
  }
}

}  // namespace sightline

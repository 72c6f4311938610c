// The triangle test against arithmetic in long double, on the triangles that break naive tests.
#include "core/shared/triangle.h"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <random>

#include "core/shared/box.h"

namespace sightline {
namespace {

using Wide = glm::vec<3, long double, glm::defaultp>;
constexpr long double kUlp = 0x1p-24L;

struct Case {
  Ray ray;
  vec3 v[3];
};

std::string describe(const Case& c, uint32_t seed, int index) {
  char text[600];
  auto p = [](const auto& a) { return std::array<double, 3>{a.x, a.y, a.z}; };
  const auto o = p(c.ray.origin), d = p(c.ray.direction), v0 = p(c.v[0]), v1 = p(c.v[1]), v2 = p(c.v[2]);
  snprintf(text, sizeof text,
           "seed %u case %d: origin %a %a %a direction %a %a %a\n%a %a %a\n%a %a %a\n%a %a %a", seed, index,
           o[0], o[1], o[2], d[0], d[1], d[2], v0[0], v0[1], v0[2], v1[0], v1[1], v1[2], v2[0], v2[1], v2[2]);
  return text;
}

/// Random rays and triangles: slivers, needles, grazing and axis-aligned rays, huge offsets, tiny scales.
class Cases {
 public:
  explicit Cases(uint32_t seed) : random_(seed) {}

  Case next() {
    Case c;
    const float scale = std::exp2(float(pick(40)) - 20), offset = pick(3) == 0 ? 1e7f * scale : scale;
    const vec3 center = point(offset);
    for (vec3& v : c.v) v = center + point(scale);
    if (pick(3) == 0) c.v[2] = glm::mix(c.v[0], c.v[1], unit()) + point(scale * std::exp2(-float(pick(24))));
    if (pick(4) == 0) c.v[1] = c.v[0] + point(scale * std::exp2(-float(pick(24))));
    if (pick(4) == 0) {
      for (vec3& v : c.v) v.y = center.y;
    }
    vec3 origin = center + point(scale * std::exp2(float(pick(6)) - 1));
    vec3 target = c.v[0];  // a vertex, a point of an edge or of the inside
    const uint32_t kind = pick(4);
    if (kind == 1) target = glm::mix(c.v[0], c.v[1], unit());
    if (kind >= 2) target = glm::mix(glm::mix(c.v[0], c.v[1], unit()), c.v[2], unit());
    if (pick(8) == 0) target += point(scale);
    if (pick(16) == 0) origin = c.v[pick(3)];
    vec3 direction = target - origin;
    if (pick(4) == 0) {
      direction = vec3(0);
      direction[pick(3)] = pick(2) ? 1.0f : -1.0f;
      const vec3 shifted = target - direction * scale;
      origin = shifted;
    }
    if (pick(4) == 0) direction = glm::mix(c.v[0] - origin, c.v[1] - origin, unit());
    if (direction == vec3(0)) direction.x = scale;
    c.ray.origin = vec4(origin, 0);
    c.ray.direction = vec4(direction, 0);
    return c;
  }

 private:
  uint32_t pick(uint32_t n) { return uint32_t(random_() % n); }
  float unit() { return float(random_() >> 8) * 0x1p-24f; }
  vec3 point(float scale) {
    const float x = unit(), y = unit(), z = unit();
    return (vec3(x, y, z) * 2.0f - 1.0f) * scale;
  }
  std::mt19937 random_;
};

float hit(const Case& c) {
  return intersectTriangle(shearRay(c.ray), c.v[0], c.v[1], c.v[2]);
}

Wide wide(const auto& v) {
  return Wide(v.x, v.y, v.z);
}

/// Nearest point of a triangle (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
Wide nearestPoint(Wide p, Wide a, Wide b, Wide c) {
  auto on_edge = [&](Wide e, Wide f) {
    const Wide along = f - e;
    const long double length = glm::dot(along, along);
    const long double s = length > 0 ? glm::clamp(glm::dot(p - e, along) / length, 0.0L, 1.0L) : 0.0L;
    return e + s * along;
  };
  Wide best = on_edge(a, b);
  for (Wide q : {on_edge(b, c), on_edge(c, a)}) {
    if (glm::distance(p, q) < glm::distance(p, best)) best = q;
  }
  const Wide n = glm::cross(b - a, c - a);
  const long double area = glm::dot(n, n);
  if (area > 0) {
    const Wide q = p - n * (glm::dot(p - a, n) / area);
    const bool inside = glm::dot(glm::cross(b - a, q - a), n) >= 0 &&
                        glm::dot(glm::cross(c - b, q - b), n) >= 0 &&
                        glm::dot(glm::cross(a - c, q - c), n) >= 0;
    if (inside && glm::distance(p, q) < glm::distance(p, best)) best = q;
  }
  return best;
}

/// S of the error analysis.
long double reach(const Case& c) {
  auto largest = [](vec3 v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); };
  return (long double)largest(vec3(c.ray.origin)) +
         std::max({largest(c.v[0]), largest(c.v[1]), largest(c.v[2])});
}

TEST(Triangle, PointOfAHitLiesAtTheTriangleAsTheAnalysisSays) {
  const uint32_t seed = 1;
  Cases cases(seed);
  int hits = 0;
  long double worst = 0;
  for (int i = 0; i < 400000; ++i) {
    const Case c = cases.next();
    const float t = hit(c);
    if (t == 0) continue;
    ++hits;
    const Wide p = wide(c.ray.origin) + (long double)t * wide(c.ray.direction);
    const Wide off = glm::abs(p - nearestPoint(p, wide(c.v[0]), wide(c.v[1]), wide(c.v[2])));
    // The nearest point in Euclid's norm is at most sqrt(3) farther in the maximum norm than the nearest
    // there.
    const long double error = std::max({off.x, off.y, off.z}) / (kUlp * reach(c));
    worst = std::max(worst, error);
    ASSERT_LE(error, 25 * 1.7321L) << describe(c, seed, i);
  }
  EXPECT_GT(hits, 100000);
  RecordProperty("worst_error_in_units", std::to_string(double(worst)));
}

TEST(Triangle, HitIsAlwaysInsideThePaddedBox) {
  const uint32_t seed = 2;
  Cases cases(seed);
  int hits = 0;
  for (int i = 0; i < 1000000; ++i) {
    const Case c = cases.next();
    const float t = hit(c);
    if (t == 0) continue;
    ++hits;
    const vec3 low = glm::min(c.v[0], glm::min(c.v[1], c.v[2]));
    const vec3 high = glm::max(c.v[0], glm::max(c.v[1], c.v[2]));
    const vec2 range = intersectBox(boxRay(c.ray, sceneReach(low, high)), low, high);
    ASSERT_LE(range.x, t) << describe(c, seed, i);
    ASSERT_GE(range.y, t) << describe(c, seed, i);
  }
  EXPECT_GT(hits, 250000);
}

/// Hit or miss and t in long double, by signed volumes; nothing where it is too close to call.
std::optional<long double> referee(const Case& c) {
  const Wide o = wide(c.ray.origin), d = wide(c.ray.direction);
  const Wide a = wide(c.v[0]) - o, b = wide(c.v[1]) - o, e = wide(c.v[2]) - o;
  const long double u = glm::dot(d, glm::cross(e, b)), v = glm::dot(d, glm::cross(a, e)),
                    w = glm::dot(d, glm::cross(b, a)), det = u + v + w;
  const long double size = std::max({glm::length(a), glm::length(b), glm::length(e)});
  const long double doubt = 64 * kUlp * reach(c) * size * glm::length(d);
  const Wide n = glm::cross(b - a, e - a);
  const bool clear = std::min({std::fabs(u), std::fabs(v), std::fabs(w)}) > doubt;
  if (!clear || std::fabs(det) < 1e-3L * glm::length(n) * glm::length(d) ||
      glm::length(n) < 1e-3L * size * size) {
    return std::nullopt;
  }
  const long double t = glm::dot(n, a) / glm::dot(n, d);
  if (std::fabs(t) * glm::length(d) < 1e5L * kUlp * reach(c)) return std::nullopt;
  const bool inside = (u > 0) == (v > 0) && (v > 0) == (w > 0);
  return inside && t > 0 ? t : 0;
}

TEST(Triangle, AgreesWithLongDoubleWhereThatIsSure) {
  const uint32_t seed = 3;
  Cases cases(seed);
  int sure_hits = 0, sure_misses = 0;
  for (int i = 0; i < 1000000; ++i) {
    const Case c = cases.next();
    const std::optional<long double> expected = referee(c);
    if (!expected) continue;
    const float t = hit(c);
    ASSERT_EQ(t > 0, *expected > 0) << describe(c, seed, i);
    ++(t > 0 ? sure_hits : sure_misses);
    const long double length = glm::length(wide(c.ray.direction));
    ASSERT_LE(std::fabs(t - *expected) * length, 1e5L * kUlp * reach(c)) << describe(c, seed, i);
  }
  EXPECT_GT(sure_hits, 10000);
  EXPECT_GT(sure_misses, 1000);
}

TEST(Triangle, OrderOfVerticesDoesNotDecideWhetherItIsHit) {
  const uint32_t seed = 4;
  Cases cases(seed);
  for (int i = 0; i < 200000; ++i) {
    const Case c = cases.next();
    Case turned = c;
    std::swap(turned.v[0], turned.v[1]);
    ASSERT_EQ(hit(c) > 0, hit(turned) > 0) << describe(c, seed, i);
  }
}

TEST(Triangle, ScalingByAPowerOfTwoScalesNothingButTheWorld) {
  const uint32_t seed = 5;
  Cases cases(seed);
  for (int i = 0; i < 200000; ++i) {
    const Case c = cases.next();
    Case scaled = c;
    scaled.ray.origin *= 1024.0f;
    scaled.ray.direction *= 1024.0f;
    for (vec3& v : scaled.v) v *= 1024.0f;
    ASSERT_EQ(hit(c), hit(scaled)) << describe(c, seed, i);
  }
}

TEST(Triangle, NoRayLeavesATetrahedronThroughAnEdgeOrVertex) {
  std::mt19937 random(6);
  auto unit = [&] { return float(random() >> 8) * 0x1p-24f; };
  auto point = [&](float s) { return vec3((unit() - 0.5f) * s, (unit() - 0.5f) * s, (unit() - 0.5f) * s); };
  int rays = 0;
  for (int i = 0; i < 500000; ++i) {
    const vec3 center = point(i % 3 == 0 ? 1e7f : 1.0f);
    vec3 v[4];
    for (vec3& corner : v) corner = center + point(8);
    if (i % 4 == 0) v[3] = glm::mix(v[0], v[1], unit()) + point(0.01f);  // flat
    const vec3 origin = (v[0] + v[1] + v[2] + v[3]) * 0.25f;
    const std::array<std::array<vec3, 3>, 4> faces{
        {{v[1], v[2], v[3]}, {v[0], v[3], v[2]}, {v[0], v[1], v[3]}, {v[0], v[2], v[1]}}};
    int sides = 0;  // the origin is truly inside if it is on the same side of all faces
    for (const auto& f : faces) {
      const Wide a = wide(f[0]), volume = glm::cross(wide(f[1]) - a, wide(f[2]) - a);
      const long double side = glm::dot(volume, wide(origin) - a);
      sides += side > 0 ? 1 : (side < 0 ? -1 : 0);
    }
    if (std::abs(sides) != 4) continue;
    vec3 target = v[i % 4];
    if (i % 5 != 0) target = glm::mix(target, v[(i + 1) % 4], unit());
    if (target == origin) continue;
    const ShearedRay sheared = shearRay({vec4(origin, 0), vec4(target - origin, 0)});
    int hits = 0;
    for (const auto& f : faces) hits += intersectTriangle(sheared, f[0], f[1], f[2]) > 0;
    ++rays;
    ASSERT_GE(hits, 1) << "seed 6 case " << i;
  }
  EXPECT_GT(rays, 200000);
}

TEST(Triangle, NeitherZeroAreaNorTheOriginItselfIsHit) {
  const Ray ray{vec4(0, 0, 0, 0), vec4(0, 0, 1, 0)};
  const ShearedRay sheared = shearRay(ray);
  EXPECT_EQ(intersectTriangle(sheared, vec3(-1, 0, 1), vec3(1, 0, 1), vec3(3, 0, 1)), 0);  // a line
  EXPECT_EQ(intersectTriangle(sheared, vec3(0, 0, 1), vec3(0, 0, 1), vec3(0, 0, 1)), 0);   // a point
  EXPECT_EQ(intersectTriangle(sheared, vec3(-1, 0, 1), vec3(1, 0, 1), vec3(0, 0, 3)), 0);  // edge on
  EXPECT_EQ(intersectTriangle(sheared, vec3(0, 0, 0), vec3(1, 0, 1), vec3(0, 1, 1)),
            0);  // begins at a vertex
  EXPECT_EQ(intersectTriangle(sheared, vec3(-1, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0)), 0);     // begins on it
  EXPECT_EQ(intersectTriangle(sheared, vec3(-1, -1, -1), vec3(2, 0, -1), vec3(0, 2, -1)), 0);  // behind
  EXPECT_EQ(intersectTriangle(sheared, vec3(-1, -1, 2), vec3(2, 0, 2), vec3(0, 2, 2)), 2);
  EXPECT_EQ(intersectTriangle(sheared, vec3(0, 2, 2), vec3(2, 0, 2), vec3(-1, -1, 2)), 2);  // its other side
}

TEST(TwoFloat, FollowsDoubleArithmetic) {
  std::mt19937 random(7);
  auto number = [&] { return std::ldexp(float(random() >> 8) * 0x1p-24f - 0.5f, int(random() % 20) - 10); };
  for (int i = 0; i < 1000000; ++i) {
    const float a = number(), b = number(), c = number();
    float d = number();
    if (i % 2 == 0 && c != 0) d = std::nextafter(a * b / c, float(i));  // cancellation
    const TwoFloat difference = differenceOfProducts(a, b, c, d);
    const double expected = double(a) * b - double(c) * d;
    const double actual = double(difference.high) + double(difference.low);
    ASSERT_LE(std::fabs(actual - expected), std::fabs(expected) * 0x1p-42) << i;
    ASSERT_EQ(difference.high < 0, expected < 0) << i;
    ASSERT_EQ(difference.high == 0, expected == 0) << i;
    const float e = number();
    if (e == 0) continue;
    const float quotient = divideTwoFloats(difference, twoSum(e, e * 1e-8f));
    const double exact = expected / (double(e) + double(e * 1e-8f));
    ASSERT_LE(std::fabs(quotient - exact), std::fabs(exact) * 0x1.01p-24) << i;
  }
}

}  // namespace
}  // namespace sightline

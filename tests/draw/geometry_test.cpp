// Positions, frusta, grown boxes and the processor's drawing, against brute force.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/draw/box_guard.h"
#include "core/draw/node_queue.h"
#include "core/draw/raster_triangle.h"
#include "tests/draw/draw_cases.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

using testing_support::Random;

struct Size {
  uint32_t width, height;
};
constexpr Size kSizes[] = {{160, 120}, {97, 61}, {1, 1}, {1, 50}, {333, 7}, {64, 64}};

/// A camera near the origin that looks anywhere, everything times `scale`.
Camera randomCamera(Random& random, float scale, Size size) {
  const glm::dvec3 eye(random.point(2 * scale));
  const double fov = 20 + 120 * random.unit();
  return makeCamera(lookAt(eye, eye + glm::dvec3(random.point(scale)), fov, size.width, size.height),
                    size.width, size.height, scale * 0x1p-20f);
}

AxisBox randomBox(Random& random, float scale) {
  const vec3 low = random.point(5 * scale);
  const vec3 extent = glm::abs(random.point(scale)) * random.unit() * random.unit();
  return {low, low + extent * vec3(float(random.pick(4) > 0), float(random.pick(4) > 0), 1)};
}

vec3 pointIn(Random& random, const AxisBox& box) {
  const auto share = [&] { return random.pick(3) == 0 ? float(random.pick(2)) : random.unit(); };
  const float x = share(), y = share(), z = share();
  return glm::clamp(box.low + (box.high - box.low) * vec3(x, y, z), box.low, box.high);
}

bool inImage(const Camera& camera, const vec3& point) {
  const vec4 p = clipPosition(camera, point);
  return p.w >= camera.eye.w && std::fabs(p.x) <= p.w && std::fabs(p.y) <= p.w;
}

TEST(DrawCamera, ShowsWhatRaysOfTheViewMeet) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const ViewFrame view = lookAt(glm::dvec3(random.point(5)), glm::dvec3(random.point(5)), 90, 256, 256);
    const Camera camera = makeCamera(view, 256, 256, 0.001f);
    const uint32_t x = random.pick(256), y = random.pick(256);
    const Ray ray = viewRay(view, x, y, 256);
    const vec4 p = clipPosition(camera, vec3(ray.origin) + vec3(ray.direction) * (0.01f + random.unit()));
    EXPECT_NEAR((p.x / p.w + 1) * 128, x + 0.5, 1e-3);
    EXPECT_NEAR((p.y / p.w + 1) * 128, y + 0.5, 1e-3);
  }
}

TEST(DrawCamera, AnglesAndDepth) {
  // 60 degrees from top to bottom: at distance 1 the upper edge is tan 30 degrees above the middle.
  const Camera camera = makeCamera(lookAt({0, 0, 0}, {0, 0, -1}, 60, 200, 100), 200, 100, 0.25f);
  const vec4 top = clipPosition(camera, {0, float(std::tan(M_PI / 6)), -1});
  EXPECT_NEAR(top.y / top.w, -1, 1e-6);
  const vec4 right = clipPosition(camera, {float(2 * std::tan(M_PI / 6)), 0, -1});
  EXPECT_NEAR(right.x / right.w, 1, 1e-6);
  EXPECT_EQ(clipPosition(camera, {0, 0, -2}).z / clipPosition(camera, {0, 0, -2}).w, 0.125f);
  for (const double fov : {1.0, 30.0, 89.0, 91.0, 120.0, 179.0}) {
    const ViewFrame view = lookAt({0, 0, 0}, {0, 0, -1}, fov, 100, 100);
    EXPECT_NEAR(view.up.y / std::tan(fov * M_PI / 360), 1, 1e-7) << fov;
  }
}

TEST(DrawCamera, SaysWhatIsWrong) {
  const ViewFrame view = lookAt({0, 0, 0}, {0, 0, -1}, 60, 10, 10);
  EXPECT_THROW(makeCamera(view, 0, 10, 1), Error);
  EXPECT_THROW(makeCamera(view, 10, 16385, 1), Error);
  EXPECT_THROW(makeCamera(view, 10, 10, 0), Error);
  EXPECT_THROW(makeCamera(ViewFrame{}, 10, 10, 1), Error);
  EXPECT_THROW(lookAt({1, 2, 3}, {1, 2, 3}, 60, 10, 10), Error);
  EXPECT_THROW(lookAt({1, 2, NAN}, {1, 2, 3}, 60, 10, 10), Error);
  EXPECT_THROW(lookAt({1, 2, 4}, {1, 2, 3}, 180, 10, 10), Error);
  const ViewFrame down = lookAt({0, 5, 0}, {0, 0, 0}, 60, 10, 10);  // up is -z
  EXPECT_LT(down.up.z, 0);
  EXPECT_EQ(nearDistance({{-3, 0, 0}, {5, 1, 1}}), 4 * 0x1p-20f);
  EXPECT_EQ(nearDistance({{1000, 1000, 1000}, {1001, 1000, 1000}}), 1 * 0x1p-20f);
  EXPECT_GT(nearDistance({}), 0);
}

TEST(DrawFrustum, WhatLandsInTheImageIsNeverOutside) {
  Random random(2);
  int outside = 0, inside = 0;
  for (int i = 0; i < 30000; ++i) {
    const float scale = std::ldexp(1.0f, int(random.pick(60)) - 30);
    const Camera camera = randomCamera(random, scale, kSizes[i % 6]);
    const AxisBox box = randomBox(random, scale);
    const FrustumSide side = Frustum(camera).sideOf(box);
    outside += side == FrustumSide::outside;
    inside += side == FrustumSide::inside;
    for (int k = 0; k < 10; ++k) {
      const bool in = inImage(camera, pointIn(random, box));
      if (in) {
        EXPECT_NE(side, FrustumSide::outside);
      }
      if (!in) {
        EXPECT_NE(side, FrustumSide::inside);
      }
    }
  }
  EXPECT_GT(outside, 3000);
  EXPECT_GT(inside, 300);
}

TEST(DrawFrustum, IsAsExactAtAnyScale) {
  // Points a hair beyond and before each edge of the image, and the near plane.
  for (const float scale : {0x1p-40f, 1.0f, 0x1p35f}) {
    const Camera camera =
        makeCamera(lookAt({0, 0, 0}, {0, 0, -scale}, 90, 100, 100), 100, 100, scale * 0x1p-10f);
    const Frustum frustum(camera);
    const auto at = [&](float x, float y, float z) {
      const vec3 p = vec3(x, y, -z) * scale;
      return frustum.sideOf({p, p});
    };
    constexpr float kMore = 1 + 0x1p-16f, kLess = 1 - 0x1p-16f;
    EXPECT_EQ(at(kLess, 0, 1), FrustumSide::inside);
    EXPECT_EQ(at(kMore, 0, 1), FrustumSide::outside);
    EXPECT_EQ(at(-kMore, 0, 1), FrustumSide::outside);
    EXPECT_EQ(at(0, kMore, 1), FrustumSide::outside);
    EXPECT_EQ(at(0, -kMore, 1), FrustumSide::outside);
    EXPECT_EQ(at(0, -kLess, 1), FrustumSide::inside);
    EXPECT_EQ(at(1, 0, 1), FrustumSide::meets);
    EXPECT_EQ(at(0, 0, 0x1p-10f * kLess), FrustumSide::outside);
    EXPECT_EQ(at(0, 0, 0x1p-10f * kMore), FrustumSide::inside);
    EXPECT_EQ(at(0, 0, -1), FrustumSide::outside);
  }
}

/// Pixels of the triangles that are nearer than the box's faces there.
int uncoveredPixels(const Camera& camera, const AxisBox& box, const std::array<glm::vec3, 3>& triangle) {
  std::vector<float> nearest(size_t{camera.size.x} * camera.size.y, 0.0f);
  const auto corner = [&](int i) {
    return glm::vec3((i & 1) != 0 ? box.high.x : box.low.x, (i & 2) != 0 ? box.high.y : box.low.y,
                     (i & 4) != 0 ? box.high.z : box.low.z);
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
      for (const auto& face :
           {std::array{base, base + u, base + u + v}, std::array{base, base + u + v, base + v}}) {
        rasterTriangle(camera, {corner(face[0]), corner(face[1]), corner(face[2])},
                       [&](const RasterPixel& p) {
                         float& depth = nearest[size_t{p.y} * camera.size.x + p.x];
                         depth = std::max(depth, p.depth);
                         return true;
                       });
      }
    }
  }
  int uncovered = 0;
  rasterTriangle(camera, triangle, [&](const RasterPixel& p) {
    uncovered += nearest[size_t{p.y} * camera.size.x + p.x] < p.depth;
    return true;
  });
  return uncovered;
}

TEST(BoxGuard, GrownBoxesLieBeforeAllTheyHold) {
  Random random(3);
  int asked = 0, as_they_are = 0;
  for (int i = 0; i < 20000; ++i) {
    const float scale = std::ldexp(1.0f, int(random.pick(40)) - 20);
    const Camera camera = randomCamera(random, scale, kSizes[i % 6]);
    // Mostly far and small: that is where a pixel is large.
    const AxisBox any = randomBox(random, scale);
    const std::array<glm::vec3, 3> triangle{pointIn(random, any), pointIn(random, any), pointIn(random, any)};
    const AxisBox box{glm::min(glm::min(triangle[0], triangle[1]), triangle[2]),
                      glm::max(glm::max(triangle[0], triangle[1]), triangle[2])};
    const auto grown = BoxGuard(camera).grown(box);
    if (!grown) continue;
    ++asked;
    ASSERT_GT(Frustum(camera).distancesOf(*grown).least, camera.eye.w);
    ASSERT_EQ(uncoveredPixels(camera, *grown, triangle), 0) << "round " << i;
    as_they_are += uncoveredPixels(camera, box, triangle) > 0;
  }
  EXPECT_GT(asked, 2000);
  EXPECT_GT(as_they_are, 10) << "boxes need not grow?";
}

TEST(BoxGuard, GrownBoxesAreNearerThanDevicesErrInDepth) {
  // A device may find the depth of a triangle and of a box's face with an error of 2^-22 of the greatest
  // depth of each. Along a ray through a point of the triangle, the grown box must begin by more than both
  // before it; large images, as there pixels are small.
  Random random(7);
  int checked = 0, as_they_are = 0;
  const auto begins = [](const AxisBox& box, const glm::dvec3& eye, const glm::dvec3& along) {
    double from = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (box.low[axis] - eye[axis]) / along[axis],
                   b = (box.high[axis] - eye[axis]) / along[axis];
      from = std::fmax(from, std::fmin(a, b));
    }
    return from;
  };
  for (int i = 0; i < 20000; ++i) {
    const float scale = std::ldexp(1.0f, int(random.pick(40)) - 20);
    const Camera camera = randomCamera(random, scale, {16384, 16384});
    const Frustum frustum(camera);
    // From near the eye to far away, at any angle, or flat.
    const vec3 eye(camera.eye), forward(camera.forward);
    std::array<glm::vec3, 3> triangle;
    for (glm::vec3& corner : triangle) {
      const float away = scale * std::ldexp(1.0f, int(random.pick(12)) - 6);
      corner = eye + (forward + random.point(0.8f)) * away;
    }
    if (const uint32_t flat = random.pick(6); flat < 3) {
      triangle[1][int(flat)] = triangle[2][int(flat)] = triangle[0][int(flat)];
    }
    const AxisBox box{glm::min(glm::min(triangle[0], triangle[1]), triangle[2]),
                      glm::max(glm::max(triangle[0], triangle[1]), triangle[2])};
    const auto grown = BoxGuard(camera).grown(box);
    if (!grown) continue;
    const double error = 0x1p-22 / frustum.distancesOf(box).least,
                 error_of_box = 0x1p-22 / frustum.distancesOf(*grown).least;
    for (int k = 0; k < 5; ++k) {
      const double b = random.unit(), c = (1 - b) * random.unit();
      const glm::dvec3 a(triangle[0]);
      const glm::dvec3 along =
          (glm::dvec3(triangle[1]) - a) * b + (glm::dvec3(triangle[2]) - a) * c + a - glm::dvec3(eye);
      const double w = glm::dot(along, glm::dvec3(forward));
      ASSERT_GT(1 / (begins(*grown, eye, along) * w) - 1 / w, error + error_of_box) << "round " << i;
      as_they_are += 1 / (begins(box, eye, along) * w) - 1 / w <= 2 * error;
      ++checked;
    }
  }
  EXPECT_GT(checked, 10000);
  EXPECT_GT(as_they_are, 1000);
}

TEST(BoxGuard, BoxesInBoxesGrowToBoxesInBoxes) {
  Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const float scale = std::ldexp(1.0f, int(random.pick(40)) - 20);
    const BoxGuard guard(randomCamera(random, scale, kSizes[i % 6]));
    const AxisBox outer = randomBox(random, scale);
    const vec3 a = pointIn(random, outer), b = pointIn(random, outer);
    const auto large = guard.grown(outer), small = guard.grown({glm::min(a, b), glm::max(a, b)});
    if (!large) continue;
    ASSERT_TRUE(small);
    ASSERT_TRUE(glm::all(glm::lessThanEqual(large->low, small->low)) &&
                glm::all(glm::greaterThanEqual(large->high, small->high)));
  }
}

TEST(BoxGuard, WhatHoldsTheCameraIsNotAskedAbout) {
  const Camera camera = makeCamera(lookAt({0, 0, 0}, {0, 0, -1}, 60, 100, 100), 100, 100, 0x1p-20f);
  const BoxGuard guard(camera);
  EXPECT_FALSE(guard.grown({{-1, -1, -1}, {1, 1, 1}}));
  EXPECT_FALSE(guard.grown({{-1, -1, -1}, {1, 1, 0}}));  // the camera is on a face
  EXPECT_FALSE(guard.grown({{5, 5, -1}, {6, 6, 1}}));    // partly behind
  EXPECT_TRUE(guard.grown({{-1, -1, -1}, {1, 1, -0.5f}}));
  EXPECT_FALSE(guard.grown({{-1, -1, -1}, {1, 1, -0x1p-18f}}));  // reaches the near plane once it has grown
  EXPECT_FALSE(
      guard.grown({{-1000, -1000, -1000}, {1000, 1000, -1}}));  // grows by half of its least distance
  const AxisBox far{{-1, -1, -101}, {1, 1, -100}};
  const auto grown = guard.grown(far);
  ASSERT_TRUE(grown);
  EXPECT_LT(grown->high.x, 1.1f);  // a hundredth of a pixel, not more
  EXPECT_GT(grown->high.x, 1.009f);
}

TEST(RasterTriangle, NeighboursShareNoPixelAndLeaveNone) {
  Random random(5);
  for (const Size size : kSizes) {
    // A mesh over the whole image and beyond, in front of a camera: every pixel is of one triangle.
    const Camera camera = makeCamera(lookAt({0, 0, 0}, {0, 0, -1}, 70, size.width, size.height), size.width,
                                     size.height, 0x1p-10f);
    constexpr int kSide = 20;
    std::vector<glm::vec3> points;
    for (int i = 0; i < (kSide + 1) * (kSide + 1); ++i) {
      const float aspect = float(size.width) / float(size.height);
      points.push_back(glm::vec3((float(i % (kSide + 1)) - kSide / 2 + 0.4f * random.unit()) * 0.1f * aspect,
                                 (float(i / (kSide + 1)) - kSide / 2 + 0.4f * random.unit()) * 0.1f, -1));
      points.back() *= 1 + random.unit();
    }
    std::vector<int> times(size_t{size.width} * size.height);
    const auto count = [&](int a, int b, int c) {
      rasterTriangle(camera, {points[size_t(a)], points[size_t(b)], points[size_t(c)]},
                     [&](const RasterPixel& p) {
                       ++times[size_t{p.y} * size.width + p.x];
                       return true;
                     });
    };
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const int i = y * (kSide + 1) + x;
        count(i, i + 1, i + kSide + 1);
        count(i + 1, i + kSide + 1, i + kSide + 2);
      }
    }
    for (const int t : times) ASSERT_EQ(t, 1);
  }
}

TEST(RasterTriangle, DepthIsThatOfTheRay) {
  Random random(6);
  int pixels = 0;
  for (int i = 0; i < 3000; ++i) {
    const Camera camera = randomCamera(random, 1, kSizes[i % 6]);
    const std::array<glm::vec3, 3> t{random.point(4), random.point(4), random.point(4)};
    const glm::dvec3 a(t[0]), eye(camera.eye),
        normal = glm::cross(glm::dvec3(t[1]) - a, glm::dvec3(t[2]) - a);
    rasterTriangle(camera, t, [&](const RasterPixel& p) {
      // The point at distance w in the pixel's direction: solved by the camera's three vectors.
      const double x = (p.x + 0.5) * 2 / camera.size.x - 1, y = (p.y + 0.5) * 2 / camera.size.y - 1;
      const glm::dmat3 rows = glm::transpose(
          glm::dmat3(glm::dvec3(camera.across), glm::dvec3(camera.down), glm::dvec3(camera.forward)));
      const glm::dvec3 along = glm::inverse(rows) * glm::dvec3(x, y, 1);
      const double facing = glm::dot(normal, along) / glm::length(normal) / glm::length(along);
      if (std::fabs(facing) < 0.2) return true;  // there, snapping moves it far along the ray
      const double w = glm::dot(normal, a - eye) / glm::dot(normal, along);
      EXPECT_NEAR(p.depth * w / camera.eye.w, 1, 0.05);
      EXPECT_EQ(p.front, facing < 0);
      ++pixels;
      return true;
    });
  }
  EXPECT_GT(pixels, 10000);
}

TEST(SoftwareImage, OrderDoesNotChangeDepth) {
  const Scene scene = generateScene("city", 5000, 1);
  const DrawScene parts = makeDrawScene(scene);
  SoftwareImage forth(scene), back(scene);
  const Camera camera = draw_cases::cityWalk(parts, 10, 97, 61)[0];
  forth.begin(camera);
  back.begin(camera);
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) forth.draw(id);
  for (uint32_t id = scene.triangleCount(); id-- > 0;) back.draw(id);
  EXPECT_EQ(forth.depth(), back.depth());
  EXPECT_GT(std::ranges::count_if(forth.depth(), [](float d) { return d > 0; }), 1000);
}

TEST(SoftwareImage, BoxesAsNearAsWhatIsThereAreSeen) {
  draw_cases::ObjectScene objects;
  objects.rectangle({-9, -9, -5}, {18, 0, 0}, {0, 18, 0});
  const Scene scene = objects.finish();
  SoftwareImage image(scene);
  image.begin(makeCamera(lookAt({0, 0, 0}, {0, 0, -1}, 60, 31, 17), 31, 17, 0.01f));
  EXPECT_TRUE(image.seesBox({{-1, -1, -9}, {1, 1, -8}}));
  EXPECT_FALSE(image.seesBox({{90, -1, -9}, {91, 1, -8}}));  // beside the image
  EXPECT_TRUE(image.draw(0));
  EXPECT_FALSE(image.draw(0));  // as near is not nearer
  EXPECT_TRUE(image.draw(1));
  EXPECT_TRUE(image.seesBox({{-1, -1, -9}, {1, 1, -5}}));
  EXPECT_TRUE(image.seesBox({{-1, -1, -5}, {1, 1, -5}}));
  EXPECT_FALSE(image.seesBox({{-1, -1, -9}, {1, 1, -5.0001f}}));
}

TEST(NodeQueue, NearestFirstThenLowestNumber) {
  std::vector<AxisBox> boxes;
  for (int i = 0; i < 40; ++i)
    boxes.push_back({glm::vec3(float(i / 2), 0, 0), glm::vec3(float(i / 2) + 0.5f, 1, 1)});
  const BoxTree tree = buildBoxTree(boxes);
  Camera camera{};
  camera.eye = {10, 0.5f, 0.5f, 1};
  NodeQueue queue(tree, camera);
  for (uint32_t n = 0; n < tree.nodes.size(); ++n) queue.push(n);
  double last = 0;
  uint32_t last_node = 0;
  while (!queue.empty()) {
    const uint32_t node = queue.pop();
    const double distance = squaredDistance(camera, tree.nodes[node].box);
    EXPECT_GE(distance, last);
    if (distance == last && last_node != 0) {
      EXPECT_GT(node, last_node);
    }
    last = distance;
    last_node = node;
  }
}

}  // namespace
}  // namespace sightline

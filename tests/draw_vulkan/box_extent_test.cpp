// Which pixels a box may touch and how near it may be: never too little, and little too much.
#include "core/shared/box_extent.h"

#include <cmath>

#include "core/draw/box_guard.h"
#include "core/draw/software_image.h"
#include "core/shared/guarded_box.h"
#include "tests/draw_vulkan/drawn_city.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

using testing_support::Random;

/// A camera somewhere, far from the origin now and then.
Camera randomCamera(Random& random, uint32_t width, uint32_t height) {
  const float far = random.pick(3) == 0 ? 3000.0f : 3.0f;
  const glm::dvec3 eye(random.point(far)), along(random.point(1));
  return makeCamera(lookAt(eye, eye + along, 60, width, height), width, height, 0x1p-12f);
}

/// Boxes ahead, some of them beside the image, flat, tiny or about the camera.
AxisBox randomBox(Random& random, const Camera& camera) {
  const glm::vec3 eye = xyz3(camera.eye), forward = xyz3(camera.forward);
  const float distance = random.unit() * (random.pick(4) == 0 ? 100.0f : 8.0f);
  const glm::vec3 middle = eye + forward * distance + random.point(0.8f * distance);
  glm::vec3 half = glm::abs(random.point(random.pick(3) == 0 ? 0.01f : 1.0f));
  if (random.pick(4) == 0) half[int(random.pick(3))] = 0;
  return {middle - half, middle + half};
}

glm::vec3 pointIn(Random& random, const AxisBox& box) {
  glm::vec3 p;
  for (int axis = 0; axis < 3; ++axis) {
    const uint32_t where = random.pick(3);  // faces, edges and corners often
    p[axis] = where == 0   ? box.low[axis]
              : where == 1 ? box.high[axis]
                           : std::clamp(box.low[axis] + random.unit() * (box.high[axis] - box.low[axis]),
                                        box.low[axis], box.high[axis]);
  }
  return p;
}

TEST(BoxExtent, HoldsAllPixelsOfWhatIsInTheBox) {
  Random random(11);
  uint64_t ahead = 0, drawn = 0, outside = 0;
  for (int round = 0; round < 4000; ++round) {
    const Camera camera = randomCamera(random, 1 + random.pick(70), 1 + random.pick(50));
    const AxisBox box = randomBox(random, camera);
    const BoxExtent extent = boxExtent(camera, box.low, box.high);
    Scene scene;
    for (int i = 0; i < 8; ++i) {
      testing_support::addTriangle(scene, pointIn(random, box), pointIn(random, box), pointIn(random, box));
    }
    scene.objects = {{"all", 0, 8}};
    SoftwareImage image(scene);
    image.begin(camera);
    for (uint32_t i = 0; i < 8; ++i) image.draw(i);
    ahead += extent.place == kBoxAhead;
    outside += extent.place == kBoxOutside;
    if (extent.place == kBoxNear) continue;
    for (uint32_t y = 0; y < camera.size.y; ++y) {
      for (uint32_t x = 0; x < camera.size.x; ++x) {
        if (image.ids()[y * camera.size.x + x] == kNoTriangle) continue;
        ++drawn;
        const uvec4& p = extent.pixels;
        ASSERT_EQ(extent.place, kBoxAhead) << "round " << round;
        ASSERT_TRUE(x >= p.x && x <= p.z && y >= p.y && y <= p.w)
            << "round " << round << ": " << x << ", " << y;
        ASSERT_LE(image.depth()[y * camera.size.x + x], extent.depth) << "round " << round;
      }
    }
  }
  EXPECT_GT(ahead, 500u);
  EXPECT_GT(outside, 500u);
  EXPECT_GT(drawn, 10'000u);
}

/// The pixels are those of the corners in double, widened by less than two; the depth that of the nearest
/// corner.
TEST(BoxExtent, HoldsLittleElse) {
  Random random(12);
  uint64_t judged = 0;
  for (int round = 0; round < 20'000; ++round) {
    const Camera camera = randomCamera(random, 1 + random.pick(2000), 1 + random.pick(1000));
    const AxisBox box = randomBox(random, camera);
    const glm::dvec3 eye(xyz3(camera.eye)), forward(xyz3(camera.forward)), across(xyz3(camera.across)),
        down(xyz3(camera.down));
    double least = INFINITY, low_x = INFINITY, high_x = -INFINITY, low_y = INFINITY, high_y = -INFINITY;
    for (int c = 0; c < 8; ++c) {
      const glm::dvec3 p = glm::dvec3(c & 1 ? box.low.x : box.high.x, c & 2 ? box.low.y : box.high.y,
                                      c & 4 ? box.low.z : box.high.z) -
                           eye;
      const double w = glm::dot(p, forward);
      least = std::min(least, w);
      const double x = (glm::dot(p, across) / w + 1) / 2 * camera.size.x,
                   y = (glm::dot(p, down) / w + 1) / 2 * camera.size.y;
      low_x = std::min(low_x, x), high_x = std::max(high_x, x), low_y = std::min(low_y, y),
      high_y = std::max(high_y, y);
    }
    const BoxExtent extent = boxExtent(camera, box.low, box.high);
    if (least > 0.5 &&
        (high_x < -1 || high_y < -1 || low_x > camera.size.x + 1 || low_y > camera.size.y + 1)) {
      EXPECT_EQ(extent.place, kBoxOutside) << "round " << round;
    }
    if (least < -0.1 && extent.place == kBoxAhead) ADD_FAILURE() << "round " << round << " is behind";
    if (least > 0.5) {
      EXPECT_NE(extent.place, kBoxNear) << "round " << round;
    }
    if (least < 0.5 || extent.place != kBoxAhead) continue;
    ++judged;
    EXPECT_GE(extent.pixels.x + 1.5, low_x);
    EXPECT_LE(extent.pixels.z - 0.5, high_x);
    EXPECT_GE(extent.pixels.y + 1.5, low_y);
    EXPECT_LE(extent.pixels.w - 0.5, high_y);
    EXPECT_LE(extent.depth, camera.eye.w / least * 1.001);
  }
  EXPECT_GT(judged, 2000u);
}

/// Boxes of units grow around what they are, and by at least what those of queries do.
TEST(BoxExtent, GuardedBoxesHoldThoseOfQueries) {
  Random random(13);
  uint64_t judged = 0;
  for (int round = 0; round < 20'000; ++round) {
    const Camera camera = randomCamera(random, 1 + random.pick(2000), 1 + random.pick(1000));
    const AxisBox box = randomBox(random, camera);
    const GuardedBox guarded = guardBox(camera, box.low, box.high, 0);
    const std::optional<AxisBox> query = BoxGuard(camera).grown(box);
    if (!guarded.whole) continue;
    ASSERT_TRUE(query) << "round " << round << ": drawn, but would be cut";
    ++judged;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(guarded.low[axis], query->low[axis]) << "round " << round;
      EXPECT_GE(guarded.high[axis], query->high[axis]) << "round " << round;
    }
  }
  EXPECT_GT(judged, 2000u);
}

}  // namespace
}  // namespace sightline

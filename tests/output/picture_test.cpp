#include "core/picture/picture.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/picture/outside_camera.h"
#include "core/picture/shading.h"

namespace sightline {
namespace {

/// Traces by trying every triangle, in double.
class BruteForce {
 public:
  explicit BruteForce(const Scene& scene) : scene_(scene) {}

  void operator()(std::span<const Ray> rays, std::span<Hit> hits) const {
    for (size_t i = 0; i < rays.size(); ++i) hits[i] = nearest(rays[i]);
  }

 private:
  Hit nearest(const Ray& ray) const {
    const glm::dvec3 origin = glm::vec3(ray.origin), direction = glm::vec3(ray.direction);
    Hit best{0, kNoTriangle};
    double nearest_t = 1e300;
    if (direction == glm::dvec3(0)) return best;
    for (uint32_t id = 0; id < scene_.triangles.size(); ++id) {
      const glm::dvec3 a = scene_.positions[scene_.triangles[id].x];
      const glm::dvec3 ab = glm::dvec3(scene_.positions[scene_.triangles[id].y]) - a;
      const glm::dvec3 ac = glm::dvec3(scene_.positions[scene_.triangles[id].z]) - a;
      const glm::dvec3 p = glm::cross(direction, ac), to_origin = origin - a, q = glm::cross(to_origin, ab);
      const double determinant = glm::dot(ab, p);
      if (determinant == 0) continue;
      const double u = glm::dot(to_origin, p) / determinant, v = glm::dot(direction, q) / determinant;
      const double t = glm::dot(ac, q) / determinant;
      if (u < 0 || v < 0 || u + v > 1 || t <= 0 || t >= nearest_t) continue;
      nearest_t = t;
      best = {float(t), id};
    }
    return best;
  }

  const Scene& scene_;
};

/// Two triangles a rectangle: corner, corner + u, corner + u + v, corner + v.
void addRectangle(Scene& scene, glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
  const uint32_t first = uint32_t(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {corner, corner + u, corner + u + v, corner + v});
  scene.triangles.push_back({first, first + 1, first + 2});
  scene.triangles.push_back({first, first + 2, first + 3});
}

/// Six walls in the order -x, +x, -y, +y, -z, +z: triangles 0, 1 are the wall at -x, and so on.
Scene closedRoom(glm::vec3 half) {
  Scene scene;
  const glm::vec3 x(2 * half.x, 0, 0), y(0, 2 * half.y, 0), z(0, 0, 2 * half.z);
  addRectangle(scene, -half, y, z);
  addRectangle(scene, -half + x, y, z);
  addRectangle(scene, -half, x, z);
  addRectangle(scene, -half + y, x, z);
  addRectangle(scene, -half, x, y);
  addRectangle(scene, -half + z, x, y);
  return scene;
}

CellPvs pvsOf(std::vector<uint32_t> triangles, glm::dvec3 center, glm::dvec3 size) {
  CellPvs pvs;
  pvs.cell = {"cell", center, size, glm::dvec3(0)};
  pvs.triangles = std::move(triangles);
  return pvs;
}

const std::vector<uint32_t> kWholeRoom{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};

std::vector<uint32_t> without(std::vector<uint32_t> triangles, const std::vector<uint32_t>& gone) {
  std::erase_if(triangles,
                [&](uint32_t id) { return std::find(gone.begin(), gone.end(), id) != gone.end(); });
  return triangles;
}

PictureOptions sized(uint32_t width, uint32_t height, CutMode cut = CutMode::kAuto) {
  PictureOptions options;
  options.width = width;
  options.height = height;
  options.cut = cut;
  return options;
}

bool isGreen(Rgb pixel) {
  return pixel.green > pixel.red + 20 && pixel.green > pixel.blue + 20;
}
bool isGrey(Rgb pixel) {
  return std::abs(pixel.red - pixel.green) < 8 && std::abs(pixel.green - pixel.blue) < 12;
}
bool isOrange(Rgb pixel) {
  return pixel.red > pixel.blue + 40;
}
bool isPureRed(Rgb pixel) {
  return pixel == Rgb{255, 0, 0};
}

uint64_t countRed(const Image& image) {
  return uint64_t(std::count_if(image.pixels.begin(), image.pixels.end(), isPureRed));
}

::testing::AssertionResult hasColor(bool (*test)(Rgb), const Image& image, glm::dvec2 place) {
  if (!(place.x >= 0 && place.x < 1 && place.y >= 0 && place.y < 1)) {
    return ::testing::AssertionFailure() << place.x << ", " << place.y << " is not in the picture";
  }
  const uint32_t x = uint32_t(place.x * image.width), y = uint32_t(place.y * image.height);
  const Rgb pixel = image.at(x, y);
  if (test(pixel)) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "pixel " << x << ", " << y << " is " << int(pixel.red) << " "
                                       << int(pixel.green) << " " << int(pixel.blue);
}

// The large panorama takes the upper two thirds and looks along the cell's longest edge, here +x; straight
// ahead is its middle, behind is its left and right side.
constexpr glm::dvec2 kAhead{0.5, 0.333}, kBehind{0.002, 0.333}, kBelow{0.5, 0.655};

TEST(InsidePicture, ShowsNoRedWhereNothingIsMissing) {
  const Scene room = closedRoom({4, 2, 3});
  const BruteForce trace(room);
  const Picture picture =
      renderInside(trace, room, pvsOf(kWholeRoom, {0, 0, 0}, {2, 0.5, 0.5}), sized(96, 72));
  EXPECT_EQ(picture.image.width, 96u);
  EXPECT_EQ(picture.image.height, 72u);
  EXPECT_EQ(picture.missing_pixels, 0u);
  EXPECT_TRUE(picture.missing_triangles.empty());
  EXPECT_EQ(countRed(picture.image), 0u);
  EXPECT_EQ(picture.scene_pixels, 96u * 48 + 92u * 20);  // all but the gaps
  EXPECT_TRUE(hasColor(isGreen, picture.image, kAhead));
  EXPECT_TRUE(hasColor(isGreen, picture.image, kBehind));
}

TEST(InsidePicture, ShowsAMissingWallRed) {
  const Scene room = closedRoom({4, 2, 3});
  const BruteForce trace(room);
  const std::vector<uint32_t> gone{2, 3};  // the wall at +x
  const CellPvs pvs = pvsOf(without(kWholeRoom, gone), {0, 0, 0}, {2, 0.5, 0.5});
  const Picture picture = renderInside(trace, room, pvs, sized(96, 72));
  EXPECT_TRUE(hasColor(isPureRed, picture.image, kAhead));
  EXPECT_TRUE(hasColor(isGreen, picture.image, kBehind));
  EXPECT_TRUE(hasColor(isGreen, picture.image, kBelow));
  EXPECT_EQ(picture.missing_triangles, gone);
  EXPECT_GT(picture.missing_pixels, 100u);
  EXPECT_EQ(countRed(picture.image), picture.missing_pixels);
}

TEST(InsidePicture, SeesBehindABoxAndBelowIt) {
  const Scene room = closedRoom({4, 2, 3});
  const BruteForce trace(room);
  const glm::dvec3 size(2, 0.5, 0.5);
  const Picture behind =
      renderInside(trace, room, pvsOf(without(kWholeRoom, {0, 1}), {0, 0, 0}, size), sized(96, 72));
  EXPECT_TRUE(hasColor(isPureRed, behind.image, kBehind));
  const Picture below =
      renderInside(trace, room, pvsOf(without(kWholeRoom, {4, 5}), {0, 0, 0}, size), sized(96, 72));
  EXPECT_TRUE(hasColor(isPureRed, below.image, kBelow));
}

TEST(InsidePicture, LooksAlongTheNormalOfAFlatCellOnly) {
  const Scene room = closedRoom({4, 2, 3});
  const BruteForce trace(room);
  // In the xy plane, looking along +z: the wall at -z (8, 9) is behind it, the one at +z (10, 11) ahead.
  const glm::dvec3 size(2, 0.5, 0);
  const Picture ahead =
      renderInside(trace, room, pvsOf(without(kWholeRoom, {10, 11}), {0, 0, 0}, size), sized(96, 72));
  EXPECT_TRUE(hasColor(isPureRed, ahead.image, kAhead));
  const Picture behind =
      renderInside(trace, room, pvsOf(without(kWholeRoom, {8, 9}), {0, 0, 0}, size), sized(96, 72));
  EXPECT_EQ(behind.missing_pixels, 0u);
}

TEST(InsidePicture, RingsTheFewPixelsThatAreMissing) {
  Scene room = closedRoom({4, 2, 3});
  addRectangle(room, {3.9f, -0.06f, -0.06f}, {0, 0.12f, 0}, {0, 0, 0.12f});  // a picture on the wall at +x
  const BruteForce trace(room);
  const Picture picture =
      renderInside(trace, room, pvsOf(kWholeRoom, {0, 0, 0}, {2, 0.5, 0.5}), sized(240, 180));
  ASSERT_GT(picture.missing_pixels, 0u);
  ASSERT_LE(picture.missing_pixels, 100u);
  EXPECT_EQ(picture.missing_triangles, (std::vector<uint32_t>{12, 13}));
  EXPECT_EQ(countRed(picture.image), picture.missing_pixels);
  // Ten pixels left of straight ahead there would be a green wall, were it not for the ring.
  uint64_t ring_pixels = 0;
  for (const Rgb& pixel : picture.image.pixels) {
    ring_pixels += pixel.red > 150 && pixel.green < 60 && !isPureRed(pixel) ? 1 : 0;
  }
  EXPECT_GT(ring_pixels, 60u);
}

/// A grey floor of 40 x 40 with a green one of 10 x 10 above its middle, a cell beside the green one.
struct OpenPlace {
  Scene scene;
  CellPvs pvs;
  OpenPlace() {
    addRectangle(scene, {-20, 0, -20}, {40, 0, 0}, {0, 0, 40});
    addRectangle(scene, {-5, 0.5f, -5}, {10, 0, 0}, {0, 0, 10});
    pvs = pvsOf({2, 3}, {9, 3, 0}, {2, 2, 4});
  }
};

glm::dvec2 placeOf(const PictureCamera& camera, glm::dvec3 point) {
  return glm::dvec2(camera.project(point));
}

TEST(OutsidePicture, ShowsTheSetGreenTheRestGreyAndTheCell) {
  const OpenPlace place;
  const BruteForce trace(place.scene);
  const PictureOptions options = sized(160, 120);
  const Picture picture = renderOutside(trace, place.scene, place.pvs, options);
  const PictureCamera camera =
      placeOutsideView(trace, place.scene, place.pvs, membership(place.scene, place.pvs.triangles), options)
          .camera;
  for (const glm::dvec3& point : {glm::dvec3(0, 0.5, 0), {-3, 0.5, 3}, {-3, 0.5, -3}}) {
    EXPECT_TRUE(hasColor(isGreen, picture.image, placeOf(camera, point))) << point.x << " " << point.z;
  }
  for (const glm::dvec3& point : {glm::dvec3(-6.5, 0, 0), {0, 0, 6.5}, {0, 0, -6.5}}) {
    EXPECT_TRUE(hasColor(isGrey, picture.image, placeOf(camera, point))) << point.x << " " << point.z;
  }
  EXPECT_TRUE(hasColor(isOrange, picture.image, placeOf(camera, {9, 3, 0})));
  EXPECT_TRUE(hasColor(isOrange, picture.image, placeOf(camera, {10, 4, 2})));
  EXPECT_EQ(picture.missing_pixels, 0u);
  EXPECT_EQ(countRed(picture.image), 0u);
}

/// Each half of the floor is open once, and once proved hidden.
TEST(OutsidePicture, TellsWhatIsOpenFromWhatIsProvedHidden) {
  const OpenPlace place;
  const BruteForce trace(place.scene);
  const PictureOptions options = sized(160, 120);
  const PictureCamera camera =
      placeOutsideView(trace, place.scene, place.pvs, membership(place.scene, place.pvs.triangles), options)
          .camera;
  for (const uint32_t open : {0u, 1u}) {
    CellPvs upper = place.pvs;
    upper.triangles = {open, 2, 3};
    const Picture picture = renderOutside(trace, place.scene, place.pvs, options, {}, &upper);
    EXPECT_TRUE(hasColor(isGreen, picture.image, placeOf(camera, {0, 0.5, 0})));
    for (const glm::dvec3& point : {glm::dvec3(0, 0, 6.5), {0, 0, -6.5}}) {
      const std::vector<Ray> down = {makeRay(glm::vec3(point) + glm::vec3(0, 1, 0), {0, -1, 0})};
      std::vector<Hit> hits(1);
      trace(down, hits);
      const auto isDark = [](Rgb pixel) { return isGrey(pixel) && pixel.green < 150; };
      EXPECT_EQ(bool(hasColor(isOrange, picture.image, placeOf(camera, point))), hits[0].triangle == open)
          << point.z;
      EXPECT_EQ(bool(hasColor(isDark, picture.image, placeOf(camera, point))), hits[0].triangle != open)
          << point.z;
    }
  }
}

TEST(OutsidePicture, KeepsTheWholeCellAndSetInThePicture) {
  const OpenPlace place;
  const BruteForce trace(place.scene);
  const std::vector<uint8_t> member = membership(place.scene, place.pvs.triangles);
  for (const auto& [width, height] : {std::pair{64u, 48u}, {48u, 64u}, {200u, 20u}}) {
    const PictureCamera camera =
        placeOutsideView(trace, place.scene, place.pvs, member, sized(width, height)).camera;
    for (const glm::dvec3& point : {glm::dvec3(10, 4, 2), {8, 2, -2}, {-5, 0.5, 5}, {5, 0.5, -5}}) {
      const glm::dvec3 seen = camera.project(point);
      EXPECT_GT(seen.z, 0);
      EXPECT_TRUE(seen.x > 0 && seen.x < 1 && seen.y > 0 && seen.y < 1)
          << width << " " << seen.x << " " << seen.y;
    }
  }
}

TEST(OutsidePicture, CutsTheCeilingOpen) {
  const Scene room = closedRoom({4, 1.5, 3});
  const BruteForce trace(room);
  const CellPvs pvs =
      pvsOf(without(kWholeRoom, {6, 7}), {2.5, -1, 0}, {0.5, 0.5, 0.5});  // all but the ceiling
  const glm::dvec3 floor_left(-2, -1.5, 0), ceiling_left(-2, 1.5, 0);
  const auto cameraFor = [&](const PictureOptions& options) {
    return placeOutsideView(trace, room, pvs, membership(room, pvs.triangles), options);
  };
  const OutsideView open = cameraFor(sized(96, 72));
  ASSERT_TRUE(open.cut_height.has_value());
  EXPECT_GT(*open.cut_height, -0.75f);
  EXPECT_LT(*open.cut_height, 1.5f);
  EXPECT_TRUE(hasColor(isGreen, renderOutside(trace, room, pvs, sized(96, 72)).image,
                       placeOf(open.camera, floor_left)));

  const PictureOptions closed_options = sized(96, 72, CutMode::kNone);
  const OutsideView closed = cameraFor(closed_options);
  EXPECT_FALSE(closed.cut_height.has_value());
  EXPECT_TRUE(hasColor(isGrey, renderOutside(trace, room, pvs, closed_options).image,
                       placeOf(closed.camera, ceiling_left)));
}

TEST(OutsidePicture, DoesNotCutTheOpen) {
  const OpenPlace place;
  const BruteForce trace(place.scene);
  const std::vector<uint8_t> member = membership(place.scene, place.pvs.triangles);
  EXPECT_FALSE(placeOutsideView(trace, place.scene, place.pvs, member, sized(64, 48)).cut_height.has_value());
}

TEST(OutsidePicture, DrawsACellThatSeesNothing) {
  const OpenPlace place;
  const BruteForce trace(place.scene);
  const Picture picture = renderOutside(trace, place.scene, pvsOf({}, {9, 3, 0}, {2, 2, 0}), sized(64, 48));
  EXPECT_GT(picture.scene_pixels, 100u);
}

TEST(Picture, RefusesAForeignSetAndAnOddSize) {
  const OpenPlace place;
  const BruteForce trace(place.scene);
  const CellPvs foreign = pvsOf({2, 4}, {9, 3, 0}, {2, 2, 4});
  EXPECT_THROW(renderInside(trace, place.scene, foreign, sized(64, 48)), Error);
  EXPECT_THROW(renderOutside(trace, place.scene, foreign, sized(64, 48)), Error);
  EXPECT_THROW(renderInside(trace, place.scene, place.pvs, sized(0, 48)), Error);
  EXPECT_THROW(renderOutside(trace, place.scene, place.pvs, sized(64, 20000)), Error);
}

}  // namespace
}  // namespace sightline

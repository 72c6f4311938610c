// Pictures of what is not simply opaque: holes show what is behind, glass tints it, and what a set lacks of
// either is red.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/api/session.h"
#include "core/picture/picture.h"
#include "core/picture/shading.h"
#include "core/picture/view_picture.h"
#include "core/scene/masked_triangle.h"
#include "tests/support/boxes.h"

namespace sightline {
namespace {

/// A wall of 8 x 8 at z = -4, before it, at z = -2, another as large, of a kind.
struct TwoWalls {
  enum Kind { kSolid, kGlass, kMask };
  Scene scene;
  std::vector<uint32_t> all = {0, 1, 2, 3};

  explicit TwoWalls(Kind kind) {
    scene.positions = {{-4, -4, -4}, {4, -4, -4}, {4, 4, -4}, {-4, 4, -4},
                       {-4, -4, -2}, {4, -4, -2}, {4, 4, -2}, {-4, 4, -2}};
    scene.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    scene.objects = {{"far", 0, 2}, {"near", 2, 2}};
    if (kind == kGlass) scene.surfaces.words = {0, 0, kSurfaceGlass, kSurfaceGlass};
    if (kind != kMask) return;
    // The left half is a hole.
    const uint32_t mask =
        addMask(scene.surfaces, 2, 1, {kWrapClamp, kWrapClamp}, [](uint64_t texel) { return texel == 1; });
    const glm::dvec2 a(0, 1), b(2, 1), c(2, 0), d(0, 0);
    scene.surfaces.masked = {*maskedTriangle(scene.surfaces, mask, {a, b, c}),
                             *maskedTriangle(scene.surfaces, mask, {a, c, d})};
    scene.surfaces.words = {0, 0, kSurfaceMasked, kSurfaceMasked | 1u};
  }
};

/// A cell that looks along -z from z = 3.
CellPvs cellWith(std::vector<uint32_t> triangles) {
  CellPvs pvs;
  pvs.cell = {"cell", {0, 0, 3}, {0.5, 0.5, 0}, {0, 180, 0}};
  pvs.triangles = std::move(triangles);
  return pvs;
}

struct Eyes {
  Session session;
  TraceRays rays = [this](std::span<const Ray> r, std::span<Hit> h) { session.traceRays(r, h); };
  TraceGlass glass = [this](std::span<const Ray> r, std::span<const Hit> h) {
    return session.traceGlass(r, h);
  };
  explicit Eyes(const Scene& scene) : session(scene) {}
  Picture inside(std::vector<uint32_t> set) {
    return renderInside(rays, session.scene(), cellWith(std::move(set)), {.width = 96, .height = 72}, glass);
  }
  Picture outside(std::vector<uint32_t> set) {
    return renderOutside(rays, session.scene(), cellWith(std::move(set)), {.width = 96, .height = 72}, glass);
  }
};

/// Of the large panorama.
constexpr uint32_t kAheadX = 48, kAheadY = 24;

TEST(PictureOfGlass, TintsWhatIsBehind) {
  const Rgb solid = Eyes(TwoWalls(TwoWalls::kSolid).scene).inside({0, 1, 2, 3}).image.at(kAheadX, kAheadY);
  const Picture glass = Eyes(TwoWalls(TwoWalls::kGlass).scene).inside({0, 1, 2, 3});
  EXPECT_EQ(glass.missing_pixels, 0u);
  const Rgb tinted = glass.image.at(kAheadX, kAheadY);
  EXPECT_FALSE(tinted == solid);
  EXPECT_GT(int(tinted.blue), int(solid.blue) + 15) << "bluish green before green";
  EXPECT_GT(tinted.green, tinted.red);
}

TEST(PictureOfGlass, IsRedWhereTheSetLacksThePaneOrWhatIsBehindIt) {
  const TwoWalls walls(TwoWalls::kGlass);
  Eyes eyes(walls.scene);
  const Picture no_pane = eyes.inside({0, 1});
  EXPECT_EQ(no_pane.missing_triangles, (std::vector<uint32_t>{2, 3}));
  EXPECT_EQ(no_pane.image.at(kAheadX, kAheadY), (Rgb{255, 0, 0}));
  const Picture no_wall = eyes.inside({2, 3});
  EXPECT_EQ(no_wall.missing_triangles, (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(no_wall.image.at(kAheadX, kAheadY), (Rgb{255, 0, 0}));
  // The opaque one hides the other: that is not missing.
  EXPECT_TRUE(Eyes(TwoWalls(TwoWalls::kSolid).scene).inside({2, 3}).image.at(kAheadX, kAheadY).red < 200);
}

TEST(PictureOfGlass, AloneAgainstTheSkyCounts) {
  TwoWalls walls(TwoWalls::kGlass);
  walls.scene.triangles.erase(walls.scene.triangles.begin(), walls.scene.triangles.begin() + 2);
  walls.scene.surfaces.words = {kSurfaceGlass, kSurfaceGlass};
  walls.scene.objects = {{"near", 0, 2}};
  Eyes eyes(walls.scene);
  EXPECT_GT(eyes.inside({0, 1}).scene_pixels, 100u);
  EXPECT_GT(eyes.inside({}).missing_pixels, 100u);
  EXPECT_GT(eyes.outside({0, 1}).scene_pixels, 100u);
}

TEST(PictureOfGlass, FromOutsideDiffersByMembership) {
  Eyes eyes(TwoWalls(TwoWalls::kGlass).scene);
  const Image in = eyes.outside({0, 1, 2, 3}).image, out = eyes.outside({0, 1}).image;
  const auto differs = [](const Image& a, const Image& b) {
    size_t count = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) count += a.pixels[i] == b.pixels[i] ? 0 : 1;
    return count;
  };
  EXPECT_GT(differs(in, out), 100u);
  EXPECT_GT(differs(in, Eyes(TwoWalls(TwoWalls::kSolid).scene).outside({0, 1, 2, 3}).image), 100u);
}

TEST(PictureOfMasks, HolesShowWhatIsBehind) {
  Eyes eyes(TwoWalls(TwoWalls::kMask).scene);
  // Seen along -z, x grows to the right; the hole is on the left.
  const Picture whole = eyes.inside({0, 1, 2, 3});
  EXPECT_EQ(whole.missing_pixels, 0u);
  const Picture without_far = eyes.inside({2, 3});
  EXPECT_EQ(without_far.image.at(kAheadX - 6, kAheadY), (Rgb{255, 0, 0}));
  EXPECT_FALSE(without_far.image.at(kAheadX + 6, kAheadY) == (Rgb{255, 0, 0}));
  const Picture without_near = eyes.inside({0, 1});
  EXPECT_FALSE(without_near.image.at(kAheadX - 6, kAheadY) == (Rgb{255, 0, 0}));
  EXPECT_EQ(without_near.image.at(kAheadX + 6, kAheadY), (Rgb{255, 0, 0}));
}

/// The picture of a view of the pixel error: the same by pixels as rays see it.
TEST(PictureOfAView, MarksMissingGlass) {
  const TwoWalls walls(TwoWalls::kGlass);
  const std::vector<uint32_t> triangles = {0, 0, kNoTriangle, 1};
  const std::vector<SeenThrough> glass = {{1, 2}, {2, 3}, {3, 2}};
  ViewFrame frame{};
  frame.origin = vec4(0, 0, 3, 0);
  frame.right = vec4(1, 0, 0, 0);
  frame.up = vec4(0, 1, 0, 0);
  frame.forward = vec4(0, 0, -1, 0);
  const auto picture = [&](std::vector<uint8_t> member) {
    return viewPicture(walls.scene, frame, 2, triangles, glass, member);
  };
  const Rgb red{255, 0, 0};
  const auto reds = [&](const Image& image) {
    std::vector<bool> list;
    for (const Rgb& p : image.pixels) list.push_back(p == red);
    return list;
  };
  EXPECT_EQ(reds(picture({1, 1, 1, 1})), (std::vector<bool>{false, false, false, false}));
  EXPECT_EQ(reds(picture({1, 1, 0, 1})), (std::vector<bool>{false, true, false, true}));
  EXPECT_EQ(reds(picture({1, 1, 1, 0})), (std::vector<bool>{false, false, true, false}));
  EXPECT_EQ(reds(picture({0, 1, 1, 1})), (std::vector<bool>{true, true, false, false}));
  EXPECT_FALSE(picture({1, 1, 1, 1}).pixels[1] == picture({1, 1, 1, 1}).pixels[0]);
}

}  // namespace
}  // namespace sightline

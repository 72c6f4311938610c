#include "core/sampling/hemicube.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "core/cell/view_cell.h"
#include "core/shared/vector.h"

namespace sightline {
namespace {

const ViewCell kBox{"box", {3, -2, 1}, {4, 2, 1}, {10, 20, 30}};

TEST(Hemicube, SamplesAreTheFrontAndTheUpperHalvesOfTheSidesOnceEach) {
  for (const uint32_t resolution : {1u, 2u, 3u, 8u, 17u}) {
    std::set<std::pair<uint32_t, uint32_t>> seen;
    for (uint32_t place = 0; place < hemicubeSamples(resolution); ++place) {
      const uint32_t view = hemicubeView(place, resolution), pixel = hemicubePixel(place, resolution);
      ASSERT_LT(view, kHemicubeViews);
      ASSERT_LT(pixel, resolution * resolution);
      if (view > 0) {
        ASSERT_LT(2 * (pixel / resolution) + 1, resolution) << "a row that looks behind the face";
      }
      ASSERT_TRUE(seen.insert({view, pixel}).second) << resolution << " " << place;
    }
    EXPECT_EQ(seen.size(), resolution * resolution + 4 * resolution * (resolution / 2));
  }
  EXPECT_EQ(hemicubeSamples(16384), 805306368u);
}

/// Every direction in front of the face goes through one sample, near its centre, and none other.
TEST(Hemicube, SeesTheHemisphereOnce) {
  constexpr uint32_t kResolution = 32;
  const std::vector<Face> faces = cellFaces(kBox);
  const Hemicube hemicube = hemicubeAt(faces[3], xyz3(faces[3].corner));
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 2000; ++i) {
    glm::vec3 direction(normal(random), normal(random), normal(random));
    if (dot3(direction, xyz3(faces[3].normal)) < 0) direction = -direction;
    int images = 0;
    double nearest = -1;
    for (const ViewFrame& view : hemicube) {
      const float ahead = dot3(direction, xyz3(view.forward));
      const float right = dot3(direction, xyz3(view.right)) / ahead,
                  up = dot3(direction, xyz3(view.up)) / ahead;
      const bool side = &view != &hemicube[0];
      images += ahead > 0 && std::fabs(right) < 1 && std::fabs(up) < 1 && (!side || up > 0) ? 1 : 0;
    }
    EXPECT_EQ(images, 1) << i;
    for (uint32_t place = 0; place < hemicubeSamples(kResolution); ++place) {
      const uint32_t pixel = hemicubePixel(place, kResolution);
      const Ray ray = viewRay(hemicube[hemicubeView(place, kResolution)], pixel % kResolution,
                              pixel / kResolution, kResolution);
      nearest =
          std::max(nearest, double(glm::dot(glm::normalize(xyz3(ray.direction)), glm::normalize(direction))));
    }
    EXPECT_GT(nearest, std::cos(std::sqrt(2.0) / kResolution)) << "the diagonal of half a pixel, i = " << i;
  }
}

TEST(Hemicube, StandsOnTheFacesByArea) {
  const std::vector<Face> faces = cellFaces(kBox);
  std::vector<int> counts(faces.size());
  std::set<std::tuple<float, float, float>> places;
  constexpr int kCount = 5600;
  for (int i = 0; i < kCount; ++i) {
    const Hemicube hemicube = placeHemicube(faces, uint64_t(i), uvec4(12345, 678, 91011, 12));
    const glm::vec3 point = xyz3(hemicube[0].origin), forward = xyz3(hemicube[0].forward);
    places.insert({point.x, point.y, point.z});
    size_t f = 0;
    while (f < faces.size() && xyz3(faces[f].normal) != forward) ++f;
    ASSERT_LT(f, faces.size());
    ++counts[f];
    const glm::vec3 from_corner = point - xyz3(faces[f].corner);
    const double u = dot3(from_corner, xyz3(faces[f].axis_u)), v = dot3(from_corner, xyz3(faces[f].axis_v));
    EXPECT_NEAR(dot3(from_corner, forward), 0, 1e-5);
    EXPECT_TRUE(u > -1e-5 && u < length3(xyz3(faces[f].edge_u)) + 1e-5) << u;
    EXPECT_TRUE(v > -1e-5 && v < length3(xyz3(faces[f].edge_v)) + 1e-5) << v;
  }
  EXPECT_EQ(places.size(), size_t(kCount)) << "no point repeats";
  double area = 0;
  for (const Face& face : faces) area += length3(xyz3(face.edge_u)) * length3(xyz3(face.edge_v));
  for (size_t f = 0; f < faces.size(); ++f) {
    const double share = length3(xyz3(faces[f].edge_u)) * length3(xyz3(faces[f].edge_v)) / area;
    EXPECT_NEAR(counts[f], kCount * share, 3) << "face " << f;
  }
}

TEST(Hemicube, TheNearPlaneScalesWithSceneAndCell) {
  Scene scene;
  scene.positions = {{-500, 0, 0}, {500, 0, 0}};
  const ViewCell cell{"cell", {0, 0, 0}, {100, 100, 0}};
  EXPECT_NEAR(hemicubeNear(scene, cellFaces(cell)), 1004.98 / 65536, 1e-4);
  ViewCell small = cell;
  small.size = {2, 0.5, 0};
  EXPECT_FLOAT_EQ(hemicubeNear(scene, cellFaces(small)), 0.5f / 256);
  for (glm::vec3& p : scene.positions) p *= 4;
  small.size *= 4;
  EXPECT_FLOAT_EQ(hemicubeNear(scene, cellFaces(small)), 2.0f / 256);
}

}  // namespace
}  // namespace sightline

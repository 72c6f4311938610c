// Where the pixel error looks from and to.
#include "core/sampling/views.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/cell/cell_frame.h"

namespace sightline {
namespace {

const ViewCell kBox{"box", {3, -2, 5}, {4, 1, 2}, {20, 30, -40}};
const ViewCell kFlat{"flat", {3, -2, 5}, {4, 1, 0}, {20, 30, -40}};

TEST(MeasureViews, AreTheSameAgainAndOthersFromAnotherSeed) {
  const auto same = [](const ViewFrame& a, const ViewFrame& b) {
    return a.origin == b.origin && a.forward == b.forward && a.right == b.right && a.up == b.up;
  };
  const auto first = measureViews(kBox, 3, 50, 7), again = measureViews(kBox, 3, 80, 7);
  const auto seed = measureViews(kBox, 3, 50, 8), cell = measureViews(kBox, 4, 50, 7);
  for (size_t i = 0; i < first.size(); ++i) {
    EXPECT_TRUE(same(first[i], again[i])) << i;
    EXPECT_FALSE(same(first[i], seed[i])) << i;
    EXPECT_FALSE(same(first[i], cell[i])) << i;
  }
}

/// Images are square and not skewed, whatever the field of view; forward x up is to the left.
TEST(MeasureViews, HaveFramesOfTheFieldOfView) {
  for (const ViewCell& cell : {kBox, kFlat}) {
    for (const double fov : {30.0, 90.0, 150.0}) {
      const double tangent = std::tan(fov / 2 * 3.14159265358979 / 180);
      for (const ViewFrame& f : measureViews(cell, 0, 300, 1, fov)) {
        const glm::vec3 forward(f.forward), right(f.right), up(f.up);
        EXPECT_NEAR(glm::length(forward), 1, 1e-6);
        EXPECT_NEAR(glm::length(right), tangent, 1e-5 * tangent);
        EXPECT_NEAR(glm::length(up), tangent, 1e-5 * tangent);
        const glm::vec3 left = glm::cross(up, forward);
        EXPECT_LT(glm::length(left * float(tangent) - right * -float(tangent)),
                  1e-4 * tangent * tangent + 1e-4);
      }
    }
  }
}

/// On the faces, by area; each of the six sees views out of the cell and into it.
TEST(MeasureViews, StandOnAllFacesOfABoxAndLookInAllDirections) {
  const CellFrame frame = cellFrame(kBox);
  const auto faces = cellFaces(kBox);
  std::vector<int> on_face(6, 0), outwards(6, 0);
  glm::dvec3 sum(0), squares(0);
  constexpr int kViews = 6000;
  for (const ViewFrame& view : measureViews(kBox, 0, kViews, 1)) {
    glm::dvec3 local;
    for (int axis = 0; axis < 3; ++axis) {
      local[axis] =
          glm::dot(glm::dvec3(view.origin) - frame.center, frame.axes[axis]) / frame.half_size[axis];
    }
    int face = -1;
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_LE(std::abs(local[axis]), 1 + 1e-5);
      if (std::abs(std::abs(local[axis]) - 1) < 1e-5) face = 2 * axis + (local[axis] > 0 ? 1 : 0);
    }
    ASSERT_GE(face, 0) << "not on the surface";
    ++on_face[size_t(face)];
    outwards[size_t(face)] += glm::dot(glm::vec3(view.forward), glm::vec3(faces[size_t(face)].normal)) > 0;
    const glm::dvec3 forward(view.forward);
    sum += forward;
    squares += forward * forward;
  }
  const double whole = 2 * (4 * 1 + 4 * 2 + 1 * 2);
  const double areas[] = {2, 2, 8, 8, 4, 4};  // -x, +x: 1 by 2; ...
  for (size_t f = 0; f < 6; ++f) {
    EXPECT_NEAR(on_face[f], kViews * areas[f] / whole, 60) << "face " << f;
    EXPECT_NEAR(outwards[f], on_face[f] / 2.0, 60) << "face " << f;
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sum[axis] / kViews, 0, 0.01);
    EXPECT_NEAR(squares[axis] / kViews, 1.0 / 3, 0.01);
  }
}

TEST(MeasureViews, OfAFlatCellLookAlongItsNormal) {
  const Face face = cellFaces(kFlat).front();
  for (const ViewFrame& view : measureViews(kFlat, 0, 100, 1)) {
    EXPECT_EQ(view.forward, face.normal);
    const glm::dvec3 from_corner = glm::dvec3(view.origin) - glm::dvec3(face.corner);
    const double u = glm::dot(from_corner, glm::dvec3(face.axis_u)),
                 v = glm::dot(from_corner, glm::dvec3(face.axis_v));
    EXPECT_TRUE(u > -1e-5 && u < 4 + 1e-5 && v > -1e-5 && v < 1 + 1e-5) << u << ", " << v;
    EXPECT_NEAR(glm::dot(from_corner, glm::dvec3(face.normal)), 0, 1e-5);
  }
}

/// A sheet (a box without width) has two sides.
TEST(MeasureViews, OfASheetLookToBothSides) {
  int right = 0;
  for (const ViewFrame& view : measureViews({"sheet", {0, 0, 0}, {0, 1, 2}}, 0, 400, 1))
    right += view.forward.x > 0;
  EXPECT_NEAR(right, 200, 20);
}

}  // namespace
}  // namespace sightline

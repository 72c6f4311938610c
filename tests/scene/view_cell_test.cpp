#include "core/cell/view_cell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/cell/cell_frame.h"

namespace sightline {
namespace {

ViewCell cellOfSize(const glm::dvec3& size, const glm::dvec3& rotation = glm::dvec3(0.0)) {
  ViewCell cell;
  cell.name = "cell";
  cell.center = {10.0, 20.0, 30.0};
  cell.size = size;
  cell.rotation = rotation;
  return cell;
}

glm::vec3 normalOf(const Face& face) {
  return glm::vec3(face.normal);
}

/// The rotation as the file format words it: about x first, then y, then z.
glm::dvec3 rotateStepByStep(glm::dvec3 v, const glm::dvec3& degrees) {
  const glm::dvec3 r = glm::radians(degrees);
  v = {v.x, v.y * std::cos(r.x) - v.z * std::sin(r.x), v.y * std::sin(r.x) + v.z * std::cos(r.x)};
  v = {v.x * std::cos(r.y) + v.z * std::sin(r.y), v.y, -v.x * std::sin(r.y) + v.z * std::cos(r.y)};
  return {v.x * std::cos(r.z) - v.y * std::sin(r.z), v.x * std::sin(r.z) + v.y * std::cos(r.z), v.z};
}

TEST(CellFaces, BoxHasSixFacesInOrder) {
  const std::vector<Face> faces = cellFaces(cellOfSize({2.0, 4.0, 6.0}));
  ASSERT_EQ(faces.size(), 6u);
  const glm::vec3 normals[6] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(normalOf(faces[i]), normals[i]) << i;
  // The +x face lies at x = 11, from (19, 27) to (21 + 2 more, 33) in y and z.
  const Face& face = faces[1];
  EXPECT_EQ(face.corner, glm::vec4(11, 18, 27, 0));
  EXPECT_EQ(face.edge_u, glm::vec4(0, 4, 0, 0));
  EXPECT_EQ(face.edge_v, glm::vec4(0, 0, 6, 0));
}

TEST(CellFaces, FlatCellLooksAlongLocalZ) {
  const std::vector<Face> faces = cellFaces(cellOfSize({2.0, 4.0, 0.0}));
  ASSERT_EQ(faces.size(), 1u);
  EXPECT_EQ(faces[0].corner, glm::vec4(9, 18, 30, 0));
  EXPECT_EQ(faces[0].axis_u, glm::vec4(1, 0, 0, 0));
  EXPECT_EQ(faces[0].axis_v, glm::vec4(0, 1, 0, 0));
  EXPECT_EQ(faces[0].normal, glm::vec4(0, 0, 1, 0));
}

TEST(CellFaces, SheetLooksToBothSides) {
  for (int axis = 0; axis < 2; ++axis) {
    glm::dvec3 size(3.0);
    size[axis] = 0.0;
    const std::vector<Face> faces = cellFaces(cellOfSize(size));
    ASSERT_EQ(faces.size(), 2u) << axis;
    EXPECT_EQ(normalOf(faces[0])[axis], -1.0f);
    EXPECT_EQ(normalOf(faces[1])[axis], 1.0f);
  }
}

TEST(CellFaces, RightAnglesAreExact) {
  for (int x = -4; x <= 4; ++x) {
    for (int y = -4; y <= 4; ++y) {
      for (int z = -4; z <= 4; ++z) {
        const glm::dvec3 rotation(90.0 * x, 90.0 * y, 90.0 * z);
        for (const Face& face : cellFaces(cellOfSize({2.0, 4.0, 6.0}, rotation))) {
          for (const glm::vec4& axis : {face.axis_u, face.axis_v, face.normal}) {
            for (int i = 0; i < 4; ++i) {
              EXPECT_TRUE(axis[i] == 0.0f || axis[i] == 1.0f || axis[i] == -1.0f)
                  << x << " " << y << " " << z;
              EXPECT_FALSE(axis[i] == 0.0f && std::signbit(axis[i]));
            }
          }
        }
      }
    }
  }
}

TEST(CellFaces, RotationIsXThenYThenZ) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> angle(-720.0, 720.0);
  for (int round = 0; round < 1000; ++round) {
    const glm::dvec3 rotation(angle(random), angle(random), angle(random));
    const std::vector<Face> faces = cellFaces(cellOfSize({1.0, 2.0, 3.0}, rotation));
    const glm::dvec3 local[6] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
    for (size_t i = 0; i < 6; ++i) {
      const glm::dvec3 expected = rotateStepByStep(local[i], rotation);
      const glm::dvec3 difference = glm::dvec3(normalOf(faces[i])) - expected;
      EXPECT_LT(glm::length(difference), 1e-6)
          << "rotation " << rotation.x << " " << rotation.y << " " << rotation.z;
      const glm::vec3 cross = glm::cross(glm::vec3(faces[i].axis_u), glm::vec3(faces[i].axis_v));
      EXPECT_LT(glm::length(cross - normalOf(faces[i])), 1e-6f);
      EXPECT_LT(glm::length(glm::vec3(faces[i].edge_u) -
                            glm::length(glm::vec3(faces[i].edge_u)) * glm::vec3(faces[i].axis_u)),
                1e-6f);
    }
  }
}

/// Not the C library's sines, which differ from one to the next: glibc 2.36 has 0x1.0000000000001p-1 here.
TEST(CellFaces, RotationDoesNotDependOnTheCLibrary) {
  const CellFrame frame = cellFrame(cellOfSize({2.0, 4.0, 6.0}, {0, 60, 0}));
  EXPECT_EQ(frame.axes[0], glm::dvec3(0.5, 0, -0x1.bb67ae8584caap-1));
  EXPECT_EQ(frame.axes[2], glm::dvec3(0x1.bb67ae8584caap-1, 0, 0.5));
}

TEST(CellFaces, FacesLieOutwardsOfTheCenter) {
  const ViewCell cell = cellOfSize({1.0, 2.0, 3.0}, {10.0, 20.0, 30.0});
  const std::vector<Face> faces = cellFaces(cell);
  for (size_t i = 0; i < 6; ++i) {
    const glm::vec3 middle = glm::vec3(faces[i].corner + 0.5f * faces[i].edge_u + 0.5f * faces[i].edge_v);
    const glm::vec3 out = middle - glm::vec3(cell.center);
    EXPECT_NEAR(glm::dot(out, normalOf(faces[i])), cell.size[int(i) / 2] * 0.5, 1e-5) << i;
    EXPECT_NEAR(glm::length(out), cell.size[int(i) / 2] * 0.5, 1e-5) << i;
  }
}

TEST(CellFaces, ScaleByPowerOfTwoScalesEveryBit) {
  ViewCell cell = cellOfSize({1.1, 2.2, 3.3}, {10.0, 20.0, 30.0});
  const std::vector<Face> faces = cellFaces(cell);
  cell.center *= 1024.0;
  cell.size *= 1024.0;
  const std::vector<Face> scaled = cellFaces(cell);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(scaled[i].corner, faces[i].corner * 1024.0f);
    EXPECT_EQ(scaled[i].edge_u, faces[i].edge_u * 1024.0f);
    EXPECT_EQ(scaled[i].edge_v, faces[i].edge_v * 1024.0f);
    EXPECT_EQ(scaled[i].normal, faces[i].normal);
  }
}

TEST(CellCorners, AreTheBoxesCorners) {
  const std::vector<glm::vec3> corners = cellCorners(cellOfSize({2.0, 4.0, 6.0}));
  ASSERT_EQ(corners.size(), 8u);
  for (const float x : {9.0f, 11.0f}) {
    for (const float y : {18.0f, 22.0f}) {
      for (const float z : {27.0f, 33.0f}) {
        EXPECT_EQ(std::count(corners.begin(), corners.end(), glm::vec3(x, y, z)), 1);
      }
    }
  }
}

TEST(CellCorners, FlatCellHasPairs) {
  const std::vector<glm::vec3> corners = cellCorners(cellOfSize({2.0, 4.0, 0.0}));
  ASSERT_EQ(corners.size(), 8u);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(corners[i], corners[i + 4]);
}

}  // namespace
}  // namespace sightline

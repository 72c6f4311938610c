#include "core/pvs/visible_from.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/cell/cell_contains.h"

namespace sightline {
namespace {

using Vec = glm::tvec3<long double>;

ViewCell box(const std::string& name, const glm::dvec3& center, const glm::dvec3& size,
             const glm::dvec3& rotation = glm::dvec3(0)) {
  return {name, center, size, rotation};
}

CellPvs baked(const ViewCell& cell, std::vector<uint32_t> triangles) {
  CellPvs pvs;
  pvs.cell = cell;
  pvs.triangles = std::move(triangles);
  return pvs;
}

/// The position in the cell's frame, turned back step by step as the cells file words it, in long double.
Vec turnedBack(const ViewCell& cell, const glm::dvec3& position) {
  const Vec r = glm::radians(Vec(cell.rotation));
  Vec v = Vec(position) - Vec(cell.center);
  v = {v.x * std::cos(r.z) + v.y * std::sin(r.z), -v.x * std::sin(r.z) + v.y * std::cos(r.z), v.z};
  v = {v.x * std::cos(r.y) - v.z * std::sin(r.y), v.y, v.x * std::sin(r.y) + v.z * std::cos(r.y)};
  return {v.x, v.y * std::cos(r.x) + v.z * std::sin(r.x), -v.y * std::sin(r.x) + v.z * std::cos(r.x)};
}

enum class Place { kInside, kOutside, kOnSurface };

/// On the surface: within what rounding to float may move it.
Place placeOf(const ViewCell& cell, const glm::dvec3& position) {
  const Vec local = glm::abs(turnedBack(cell, position));
  const Vec half = Vec(cell.size) * 0.5L;
  const long double rounding = (glm::length(Vec(cell.center)) + glm::length(half)) * 0x1p-21L;
  Place place = Place::kInside;
  for (int i = 0; i < 3; ++i) {
    if (local[i] > half[i] + rounding) return Place::kOutside;
    if (local[i] >= half[i] - rounding) place = Place::kOnSurface;
  }
  return place;
}

TEST(VisibleFrom, IsTheFirstCellThatContainsThePositionAndNoOther) {
  constexpr int kCells = 60, kPositions = 20000;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-10, 10), size(1, 9), degrees(-180, 180);
  PvsFile pvs;
  for (int i = 0; i < kCells; ++i) {
    const bool turned = i % 3 != 0;
    pvs.cells.push_back(
        baked(box("cell-" + std::to_string(i), {place(random), place(random), place(random)},
                  {size(random), size(random), size(random)},
                  turned ? glm::dvec3(degrees(random), degrees(random), degrees(random)) : glm::dvec3(0)),
              {uint32_t(i), uint32_t(kCells + i)}));
  }
  int in_none = 0, in_one = 0, in_several = 0, on_surface = 0;
  for (int n = 0; n < kPositions; ++n) {
    const glm::dvec3 position(place(random), place(random), place(random));
    const CellPvs* expected = nullptr;
    int holders = 0;
    bool unsure = false;
    for (const CellPvs& cell : pvs.cells) {
      const Place where = placeOf(cell.cell, position);
      unsure = unsure || where == Place::kOnSurface;
      if (where == Place::kOutside) continue;
      if (holders++ == 0) expected = &cell;
    }
    if (unsure) {
      ++on_surface;
      continue;
    }
    ++(holders == 0 ? in_none : holders == 1 ? in_one : in_several);
    ASSERT_EQ(cellAt(pvs, position), expected) << "position " << n << " of seed 7";
    const auto visible = visibleFrom(pvs, position);
    ASSERT_EQ(visible.has_value(), expected != nullptr);
    if (visible) {
      ASSERT_EQ(visible->data(), expected->triangles.data());
    }
  }
  EXPECT_GT(in_none, 1000);
  EXPECT_GT(in_one, 1000);
  EXPECT_GT(in_several, 1000);
  EXPECT_LT(on_surface, kPositions / 100);
}

/// Cells from 0.1 k to 0.1 (k + 1), whose faces no float holds exactly.
TEST(VisibleFrom, BetweenCellsThatShareAFaceNoPositionIsLost) {
  PvsFile pvs;
  for (int k = 0; k < 100; ++k) {
    pvs.cells.push_back(baked(box(std::to_string(k), {0.1 * k + 0.05, 7, -3}, {0.1, 2, 2}), {uint32_t(k)}));
  }
  for (int k = 1; k < 100; ++k) {
    for (const double x : {0.1 * k, double(float(0.1 * k)), k / 10.0, std::nextafter(0.1 * k, 100.0)}) {
      const glm::dvec3 on_face(x, 7.25, -3.5);
      EXPECT_TRUE(cellContains(pvs.cells[size_t(k - 1)].cell, on_face)) << k;
      EXPECT_TRUE(cellContains(pvs.cells[size_t(k)].cell, on_face)) << k;
      EXPECT_EQ(cellAt(pvs, on_face), &pvs.cells[size_t(k - 1)]) << k;
    }
    EXPECT_EQ(cellAt(pvs, {0.1 * k + 1e-5, 7, -3}), &pvs.cells[size_t(k)]);
    EXPECT_EQ(cellAt(pvs, {0.1 * k - 1e-5, 7, -3}), &pvs.cells[size_t(k - 1)]);
  }
}

TEST(VisibleFrom, BelongsToTheCellAtItsCornersButNotBeyond) {
  const ViewCell cell = box("cell", {10, 20, 30}, {2, 4, 8});  // corners that floats hold
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    const glm::dvec3 corner = cell.center + sign * cell.size * 0.5;
    EXPECT_TRUE(cellContains(cell, corner)) << i;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 beyond = corner;
      beyond[axis] = std::nextafter(corner[axis], sign[axis] * 1000);
      EXPECT_FALSE(cellContains(cell, beyond)) << i << " axis " << axis;
    }
  }
}

TEST(VisibleFrom, OfAFlatCellHoldsThePositionsOnIt) {
  const ViewCell flat = box("flat", {1, 2, 3}, {2, 2, 0}, {90, 0, 0});  // looks along -y
  EXPECT_TRUE(cellContains(flat, {1.5, 2, 3.5}));
  EXPECT_FALSE(cellContains(flat, {1.5, 2.001, 3.5}));
  EXPECT_FALSE(cellContains(flat, {1.5, 1.999, 3.5}));
  EXPECT_FALSE(cellContains(flat, {1.5, 2, 4.5}));
}

TEST(VisibleFrom, KnowsNothingOfOtherPositions) {
  PvsFile pvs;
  EXPECT_FALSE(visibleFrom(pvs, {0, 0, 0}).has_value());
  pvs.cells.push_back(baked(box("blind", {0, 0, 0}, {1, 1, 1}), {}));
  pvs.planned = {pvs.cells[0].cell, box("planned only", {5, 0, 0}, {1, 1, 1})};
  const auto nothing = visibleFrom(pvs, {0.25, 0, 0});
  ASSERT_TRUE(nothing.has_value());
  EXPECT_TRUE(nothing->empty());
  EXPECT_FALSE(visibleFrom(pvs, {5, 0, 0}).has_value());
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    for (const double bad : {kNaN, kInfinity, -kInfinity, 1e300}) {
      glm::dvec3 position(0);
      position[axis] = bad;
      EXPECT_EQ(cellAt(pvs, position), nullptr) << bad;
    }
  }
}

}  // namespace
}  // namespace sightline

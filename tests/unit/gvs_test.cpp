// Rays of the original guided visibility sampling.
#include <gtest/gtest.h>

#include "core/cell/view_cell.h"
#include "core/shared/gvs_reverse.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

using testing_support::Random;

uint32_t levelOf(uint32_t position) {
  return position % 8 == 0 ? 0 : (position % 4 == 0 ? 1 : (position % 2 == 0 ? 2 : 3));
}

TEST(GvsBorder, LevelsShareOutAllPositions) {
  std::vector<int> times(kGvsPositions, 0);
  for (uint32_t level = 0; level < kGvsLevels; ++level) {
    for (uint32_t slot = 0; slot < gvsSlots(level); ++slot) {
      const uint32_t position = gvsPosition(level, slot);
      ASSERT_LT(position, kGvsPositions);
      ++times[position];
      EXPECT_EQ(levelOf(position), level);
      if (level == 0) continue;
      const uint32_t before = gvsBefore(level, position), after = gvsAfter(level, position);
      EXPECT_LT(levelOf(before), level);
      EXPECT_LT(levelOf(after), level);
      EXPECT_EQ((after + kGvsPositions - position) % kGvsPositions, position - before);
      EXPECT_EQ(gvsFirstVertex(before), gvsFirstVertex(position)) << "on the same edge";
    }
  }
  EXPECT_EQ(times, std::vector<int>(kGvsPositions, 1));
}

TEST(GvsBorder, DividesBetweenDifferentTracedTriangles) {
  EXPECT_TRUE(gvsDivides(1, 2));
  EXPECT_TRUE(gvsDivides(1, kNoTriangle));
  EXPECT_FALSE(gvsDivides(3, 3));
  EXPECT_FALSE(gvsDivides(kNoTriangle, kNoTriangle));
  EXPECT_FALSE(gvsDivides(kNotTraced, 3));
  EXPECT_FALSE(gvsDivides(3, kNotTraced));
}

/// The vertices are those of gvs++'s polygon without samples between, and the places between lie on lines.
TEST(GvsBorder, PositionsLieOnThePolygon) {
  Random random(7);
  StageParams params{};
  params.distances = vec4(0x1p-17f, 0, 0x1p-10f, 0);
  for (int i = 0; i < 1000; ++i) {
    const vec3 p0 = random.point(4), p1 = random.point(4), p2 = random.point(4), origin = random.point(9);
    vec3 vertices[9];
    for (uint32_t v = 0; v < 9; ++v) {
      const BorderEdge edge = borderEdge(p0, p1, p2, v / 3, origin, params);
      vertices[v] = gvsVertexOf(edge, v);
      ASSERT_EQ(vertices[v], borderPoint(edge, v)) << i;
    }
    for (uint32_t position = 0; position < kGvsPositions; ++position) {
      const vec3 a = vertices[gvsFirstVertex(position)], b = vertices[gvsSecondVertex(position)];
      const vec3 point = gvsPoint(a, b, position);
      const double share = position % 8 / 8.0;
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_NEAR(point[axis], a[axis] * (1 - share) + b[axis] * share, 1e-5) << i << ", " << position;
      }
    }
  }
}

TEST(GvsReverse, DiscontinuityIsWhatIsNearerThanThePlane) {
  StageParams params{};
  params.distances = vec4(0, 0, 0, 1);
  const vec3 a(-1, -1, 10), b(1, -1, 10), c(0, 1, 10);
  const Ray ray = rayTo(vec3(0, 0, 0), vec3(0, 0, 20));  // the plane is at t = 0.5
  EXPECT_TRUE(isGvsDiscontinuity(ray, {0.4f, 5}, a, b, c, params));
  EXPECT_FALSE(isGvsDiscontinuity(ray, {0.4f, kNoTriangle}, a, b, c, params));
  EXPECT_FALSE(isGvsDiscontinuity(ray, {0.46f, 5}, a, b, c, params)) << "within delta_RS";
  EXPECT_FALSE(isGvsDiscontinuity(ray, {0.9f, 5}, a, b, c, params)) << "farther";
  EXPECT_FALSE(isGvsDiscontinuity(rayTo(vec3(0, 0, 0), vec3(0, 9, 0)), {0.1f, 5}, a, b, c, params))
      << "beside the plane";
  EXPECT_FALSE(isGvsDiscontinuity(rayTo(vec3(0, 0, 0), vec3(0, 0, -9)), {0.1f, 5}, a, b, c, params))
      << "away from it";
}

/// Mutated origins lie on a face that looks at the target, their rays leave the cell, and pass the occluder
/// just beside it.
TEST(GvsReverse, RaysLeaveTheCellAndPassTheOccluder) {
  Random random(11);
  StageParams params{};
  params.distances = vec4(0x1p-12f, 0, 0x1p-10f, 0);
  int made = 0, outside = 0, wrong = 0;
  for (int i = 0; i < 20'000; ++i) {
    const bool flat = i % 2 == 0;
    const ViewCell cell{"", {0, 0, 0}, {6, 4, flat ? 0.0 : 2.0}, {20, 30, 40}};
    const std::vector<Face> faces = cellFaces(cell);
    const Face& face = faces[random.pick(uint32_t(faces.size()))];
    const vec3 origin =
        vec3(face.corner) + vec3(face.edge_u) * random.unit() + vec3(face.edge_v) * random.unit();
    const vec3 away = vec3(face.normal) * (20.0f + random.unit());
    const vec3 p0 = origin + away + random.point(8), p1 = origin + away + random.point(8),
               p2 = origin + away + random.point(8);
    const Ray found = rayTo(origin, (p0 + p1 + p2) / 3.0f);
    ReverseItem item{};
    item.target = vec4(p0 + (p0 - p1) * 1e-3f, 0);
    // An occluder about the middle of the way.
    const vec3 middle = (origin + vec3(item.target)) * 0.5f;
    const vec3 side = random.point(1), other = random.point(1);
    item.a = vec4(middle + side, 0);
    item.b = vec4(middle + other, 0);
    item.c = vec4(middle - side - other, 0);
    item.number = uvec4(0, 0, 1, 1);
    const ReverseItem mutated = gvsReverseItem(item, found, p0, p1, p2, params);
    ASSERT_EQ(mutated.number.w, 1u) << i;
    for (uint32_t k = 0; k < 2; ++k) {
      int on_faces = 0;
      for (const Face& f : faces) {
        const Ray ray = gvsReverseRay(mutated, f, k, params);
        if (!hasDirection(ray)) continue;
        ++on_faces;
        const vec3 start(ray.origin), direction(ray.direction), from_corner = start - vec3(f.corner);
        ASSERT_NEAR(glm::dot(from_corner, vec3(f.normal)), 0, 1e-5) << i;
        ASSERT_GT(glm::dot(direction, vec3(f.normal)), 0) << i;
        ASSERT_LE(glm::dot(from_corner, vec3(f.axis_u)), glm::length(vec3(f.edge_u)) + 1e-5f) << i;
        ASSERT_LE(glm::dot(from_corner, vec3(f.axis_v)), glm::length(vec3(f.edge_v)) + 1e-5f) << i;
        // Past the occluder: the ray misses it, one that is moved towards its centre hits it.
        const auto hits = [&](vec3 through) {
          const Ray test = rayTo(vec3(item.target), through);
          return intersectTriangle(shearRay(test), vec3(item.a), vec3(item.b), vec3(item.c)) > 0;
        };
        const vec3 beside(k == 0 ? mutated.a : mutated.b);
        wrong += hits(beside);
        // A segment of hardly more than the margin has no inside to aim at.
        const vec3 opposite(k == 0 ? mutated.b : mutated.a);
        wrong += glm::distance(beside, opposite) > 0.3f && !hits(glm::mix(beside, opposite, 0.1f));
      }
      ASSERT_LE(on_faces, 1) << i;
      made += on_faces;
      outside += on_faces == 0;
    }
  }
  EXPECT_GT(made, 5000);
  EXPECT_GT(outside, 5000);
  EXPECT_LE(wrong, made / 1000) << "occluders seen edge on alone may round to the other side";
}

TEST(GvsReverse, NothingWhereThereIsNoOccluderOrNoPlane) {
  StageParams params{};
  params.distances = vec4(0, 0.01f, 0, 0);
  const vec3 a(-1, -1, 10), b(1, -1, 10), c(0, 1, 10);
  ReverseItem item{};
  item.target = vec4(2, 0, 10, 0);
  item.a = vec4(-1, -1, 5, 0), item.b = vec4(1, -1, 5, 0), item.c = vec4(0, 1, 5, 0);
  const Ray found = rayTo(vec3(0), vec3(0, 0, 10));
  EXPECT_EQ(gvsReverseItem(item, found, a, b, c, params).number.w, 0u) << "no occluder";
  item.number.w = 1;
  EXPECT_EQ(gvsReverseItem(item, found, a, b, c, params).number.w, 1u);
  EXPECT_EQ(gvsReverseItem(item, rayTo(vec3(0), vec3(1, 0, 0)), a, b, c, params).number.w, 0u)
      << "the ray runs beside its triangle";
  item.target = vec4(0, 0, 12, 0);
  EXPECT_EQ(gvsReverseItem(item, found, a, b, c, params).number.w, 0u) << "target straight behind";
  item.target = vec4(2, 0, 10, 0);
  for (vec4* corner : {&item.a, &item.b, &item.c}) corner->y += 50;
  EXPECT_EQ(gvsReverseItem(item, found, a, b, c, params).number.w, 0u) << "the plane misses the occluder";
}

}  // namespace
}  // namespace sightline

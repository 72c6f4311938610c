#include "core/generate/mesh_builder.h"

#include <array>
#include <cmath>

namespace sightline {

Turn turn(float share_of_full_turn) {
  // Reduced to an eighth of a turn either side of a quarter's multiple; Taylor series in double, whose
  // remainder there (x^13 / 13!) is below the spacing of float.
  const double share = double(share_of_full_turn);
  const double quarter = std::floor(share * 4 + 0.5);
  const double x = (share - quarter / 4) * 6.283185307179586476925;
  const double xx = x * x;
  const double s = x * (1 - xx / 6 * (1 - xx / 20 * (1 - xx / 42 * (1 - xx / 72 * (1 - xx / 110)))));
  const double c =
      1 - xx / 2 * (1 - xx / 12 * (1 - xx / 30 * (1 - xx / 56 * (1 - xx / 90 * (1 - xx / 132)))));
  switch (int64_t(quarter) & 3) {
    case 0:
      return {float(s), float(c)};
    case 1:
      return {float(c), float(-s)};
    case 2:
      return {float(-s), float(-c)};
    default:
      return {float(-c), float(s)};
  }
}

Frame Frame::at(glm::vec3 p, float yaw_turn) const {
  const Turn t = turn(yaw_turn);
  return {point(p), t.cos * x - t.sin * z, y, t.sin * x + t.cos * z};
}

void MeshBuilder::clear() {
  frame = {};
  matter_ = Matter::kSolid;
  size_ = {};
  positions_.clear();
  triangles_.clear();
  matters_.clear();
  places_.clear();
}

void MeshBuilder::count(uint64_t vertices, uint64_t triangles) {
  size_.vertices += vertices;
  if (matter_ == Matter::kLeaf) size_.leaf_vertices += vertices;
  size_.triangles[size_t(matter_)] += triangles;
}

uint32_t MeshBuilder::vertex(glm::vec3 p, glm::vec2 place) {
  if (!counting_) {
    positions_.push_back(frame.point(p));
    if (matter_ == Matter::kLeaf) {
      places_.resize(positions_.size(), kNoPlace);
      places_.back() = place;
    }
  }
  count(1, 0);
  return uint32_t(size_.vertices - 1);
}

void MeshBuilder::triangle(uint32_t a, uint32_t b, uint32_t c) {
  if (!counting_) {
    triangles_.push_back({a, b, c});
    if (options_.alpha) matters_.push_back(matter_);
  }
  count(0, 1);
}

void MeshBuilder::quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  triangle(a, b, c);
  triangle(a, c, d);
}

void MeshBuilder::quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
  const uint32_t first = vertex(a, {0, 1});
  vertex(b, {1, 1});
  vertex(c, {1, 0});
  vertex(d, {0, 0});
  quad(first, first + 1, first + 2, first + 3);
}

void MeshBuilder::board(const std::array<glm::vec3, 4>& front, glm::vec3 to_back) {
  const uint32_t first = uint32_t(size_.vertices), back = first + 4;
  for (const glm::vec3& corner : front) vertex(corner);
  for (const glm::vec3& corner : front) vertex(corner + to_back);
  quad(first, first + 1, first + 2, first + 3);
  quad(back + 3, back + 2, back + 1, back);
  for (uint32_t i = 0; i < 4; ++i) {
    const uint32_t j = (i + 1) & 3;
    quad(first + j, first + i, back + i, back + j);
  }
}

void MeshBuilder::box(glm::vec3 low, glm::vec3 high, uint32_t leave_out) {
  // Corner i: bit 0 x, bit 1 y, bit 2 z.
  static constexpr uint8_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                           {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  const uint32_t first = uint32_t(size_.vertices);
  for (uint32_t i = 0; i < 8; ++i) {
    vertex({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  }
  for (uint32_t f = 0; f < 6; ++f) {
    if ((leave_out >> f & 1) != 0 && !options_.closed) continue;
    quad(first + kFaces[f][0], first + kFaces[f][1], first + kFaces[f][2], first + kFaces[f][3]);
  }
}

void MeshBuilder::patch(glm::vec3 corner, glm::vec3 u, glm::vec3 v, uint32_t nu, uint32_t nv) {
  sheet(nu, nv, false, [&](uint32_t i, uint32_t j) {
    return corner + u * (float(i) / float(nu)) + v * (float(j) / float(nv));
  });
}

void MeshBuilder::lathe(std::span<const LathePoint> profile, uint32_t sides) {
  uint32_t below = 0;
  for (size_t k = 0; k < profile.size(); ++k) {
    const LathePoint p = profile[k];
    const uint32_t ring = uint32_t(size_.vertices);
    if (p.radius == 0) {
      vertex({0, p.height, 0});
    } else {
      for (uint32_t i = 0; i < sides; ++i) {
        const Turn t = turn(float(i) / float(sides));
        vertex({p.radius * t.cos, p.height, p.radius * t.sin});
      }
    }
    for (uint32_t i = 0; k > 0 && i < sides; ++i) {
      const uint32_t j = i + 1 == sides ? 0 : i + 1;
      const bool pole = p.radius == 0, pole_below = profile[k - 1].radius == 0;
      if (pole && pole_below) continue;
      if (pole) {
        triangle(below + j, below + i, ring);
      } else if (pole_below) {
        triangle(below, ring + i, ring + j);
      } else {
        quad(below + i, ring + i, ring + j, below + j);
      }
    }
    below = ring;
  }
}

void MeshBuilder::tube(std::span<const glm::vec3> path, float radius, uint32_t sides, bool capped) {
  const std::vector<float> radii(path.size(), radius);
  tube(path, radii, sides, capped);
}

namespace {

/// Any unit vector at right angles to the unit vector d.
glm::vec3 sideOf(glm::vec3 d) {
  const glm::vec3 helper = std::fabs(d.y) < 0.8f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  return unitVector(glm::cross(d, helper));
}

}  // namespace

void MeshBuilder::tube(std::span<const glm::vec3> path, std::span<const float> radii, uint32_t sides,
                       bool capped) {
  const uint32_t first = uint32_t(size_.vertices);
  const size_t rings = path.size();
  if (counting_) {
    count(rings * sides + (capped ? 2 : 0), (rings - 1) * sides * 2 + (capped ? 2 * sides : 0));
    return;
  }
  glm::vec3 side = sideOf(unitVector(path[1] - path[0]));
  for (size_t k = 0; k < rings; ++k) {
    // The ring stands across the mean of the two segments; its x axis is carried along, not twisted.
    const glm::vec3 in = k > 0 ? unitVector(path[k] - path[k - 1]) : unitVector(path[1] - path[0]);
    const glm::vec3 out = k + 1 < rings ? unitVector(path[k + 1] - path[k]) : in;
    const glm::vec3 sum = in + out;
    const glm::vec3 along = glm::dot(sum, sum) > 0.01f ? unitVector(sum) : in;
    const glm::vec3 across = side - along * glm::dot(side, along);
    side = glm::dot(across, across) > 0.01f ? unitVector(across) : sideOf(along);
    const glm::vec3 up = glm::cross(along, side);
    for (uint32_t i = 0; i < sides; ++i) {
      const Turn t = turn(float(i) / float(sides));
      vertex(path[k] + radii[k] * (t.cos * side + t.sin * up));
    }
  }
  for (uint32_t k = 0; k + 1 < rings; ++k) {
    for (uint32_t i = 0; i < sides; ++i) {
      const uint32_t j = i + 1 == sides ? 0 : i + 1;
      const uint32_t a = first + k * sides;
      quad(a + i, a + j, a + sides + j, a + sides + i);
    }
  }
  if (!capped) return;
  const uint32_t start = vertex(path.front()), end = vertex(path.back());
  const uint32_t last = first + uint32_t(rings - 1) * sides;
  for (uint32_t i = 0; i < sides; ++i) {
    const uint32_t j = i + 1 == sides ? 0 : i + 1;
    triangle(start, first + j, first + i);
    triangle(end, last + i, last + j);
  }
}

}  // namespace sightline

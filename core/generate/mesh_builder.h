#pragma once
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace sightline {

/// Sine and cosine of a full turn's share, by polynomials: the same bits on every platform, error < 1e-7.
struct Turn {
  float sin, cos;
};
Turn turn(float share_of_full_turn);

inline glm::vec3 unitVector(glm::vec3 v) {
  return v / std::sqrt(glm::dot(v, v));
}

/// A local coordinate system: point = origin + p.x * x + p.y * y + p.z * z.
struct Frame {
  glm::vec3 origin{0};
  glm::vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  glm::vec3 point(glm::vec3 p) const { return origin + p.x * x + p.y * y + p.z * z; }
  /// A frame inside this one, at p, turned about y by a share of a full turn.
  Frame at(glm::vec3 p, float yaw_turn = 0) const;
};

/// Faces of a box to leave out, where it stands on or leans against something.
enum BoxFaces : uint32_t {
  kNoLowX = 1,
  kNoHighX = 2,
  kNoLowY = 4,
  kNoHighY = 8,
  kNoLowZ = 16,
  kNoHighZ = 32
};

/// A point of a surface of revolution.
struct LathePoint {
  float radius, height;
};

/// Collects triangles, or only counts them (then nothing is stored, and the counts are the same).
/// Shapes are given in the current frame; triangles are counter-clockwise seen from outside.
class MeshBuilder {
 public:
  enum class Mode { kStore, kCount };
  explicit MeshBuilder(Mode mode = Mode::kStore) : counting_(mode == Mode::kCount) {}

  Frame frame;

  uint32_t vertex(glm::vec3 p);
  void triangle(uint32_t a, uint32_t b, uint32_t c);
  void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d);
  void quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d);

  /// Axis-aligned in the frame; low < high on every axis. leave_out: BoxFaces.
  void box(glm::vec3 low, glm::vec3 high, uint32_t leave_out = 0);
  /// nu by nv quads over corner + [0, 1] u + [0, 1] v; faces u x v.
  void patch(glm::vec3 corner, glm::vec3 u, glm::vec3 v, uint32_t nu, uint32_t nv);
  /// nu by nv quads of any surface: point(i, j) is called once for each vertex, i = 0..nu, j = 0..nv, and not
  /// at all where only counting. closed: column nu is column 0. Faces d/di x d/dj.
  template <class Point>
  void sheet(uint32_t nu, uint32_t nv, bool closed, Point&& point);
  /// Turns the profile (from bottom to top, outside to the right) about the frame's y axis. sides >= 3.
  /// First and last point may have radius 0 (a pole); an open end stays open.
  void lathe(std::span<const LathePoint> profile, uint32_t sides);
  /// A pipe along the points (2 or more, none twice in a row), with one radius; sides >= 3.
  void tube(std::span<const glm::vec3> path, float radius, uint32_t sides, bool capped);
  /// Same, with a radius for every point.
  void tube(std::span<const glm::vec3> path, std::span<const float> radii, uint32_t sides, bool capped);

  uint64_t vertexCount() const { return vertex_count_; }
  uint64_t triangleCount() const { return triangle_count_; }
  const std::vector<glm::vec3>& positions() const { return positions_; }
  const std::vector<glm::uvec3>& triangles() const { return triangles_; }
  void clear();

 private:
  bool counting_;
  uint64_t vertex_count_ = 0;
  uint64_t triangle_count_ = 0;
  std::vector<glm::vec3> positions_;
  std::vector<glm::uvec3> triangles_;
};

template <class Point>
void MeshBuilder::sheet(uint32_t nu, uint32_t nv, bool closed, Point&& point) {
  const uint32_t columns = closed ? nu : nu + 1;
  if (counting_) {
    vertex_count_ += uint64_t(columns) * (nv + 1);
    triangle_count_ += uint64_t(nu) * nv * 2;
    return;
  }
  const uint32_t first = uint32_t(vertex_count_);
  for (uint32_t j = 0; j <= nv; ++j) {
    for (uint32_t i = 0; i < columns; ++i) vertex(point(i, j));
  }
  for (uint32_t j = 0; j < nv; ++j) {
    for (uint32_t i = 0; i < nu; ++i) {
      const uint32_t a = first + j * columns, b = a + columns, k = closed && i + 1 == nu ? 0 : i + 1;
      quad(a + i, a + k, b + k, b + i);
    }
  }
}

}  // namespace sightline

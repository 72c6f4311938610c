#pragma once
#include <array>
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

/// What a triangle is made of. Where alpha is not asked for, all is solid.
enum class Matter : uint8_t {
  kSolid,
  kPane,  ///< of glass
  kLeaf   ///< a card with a picture of leaves, whose rest is holes
};

/// What a scene is asked to be made of.
struct MeshOptions {
  bool alpha = false;   ///< shapes may be of panes and leaves
  bool closed = false;  ///< shapes that stand on or lean against something have the faces there, too
};

/// How many triangles of each matter, and vertices.
struct MeshSize {
  uint64_t vertices = 0;                ///< in all
  uint64_t leaf_vertices = 0;           ///< of them: made for leaves
  std::array<uint64_t, 3> triangles{};  ///< by Matter

  uint64_t allTriangles() const { return triangles[0] + triangles[1] + triangles[2]; }
  uint64_t of(Matter matter) const { return triangles[size_t(matter)]; }
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
  explicit MeshBuilder(Mode mode = Mode::kStore, MeshOptions options = {})
      : counting_(mode == Mode::kCount), options_(options) {}

  Frame frame;

  /// Following triangles are of this matter, if alpha is asked for.
  void use(Matter matter) { matter_ = options_.alpha ? matter : Matter::kSolid; }
  /// Whether panes and leaves are asked for.
  bool alpha() const { return options_.alpha; }
  bool closed() const { return options_.closed; }

  /// place: of a leaf's, in its picture, 0..1 from the upper left corner.
  uint32_t vertex(glm::vec3 p, glm::vec2 place = glm::vec2(0));
  void triangle(uint32_t a, uint32_t b, uint32_t c);
  void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d);
  /// Of leaves: the whole picture, its lower edge from a to b.
  void quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d);

  /// A board: of the four corners of its front, and as thick as from these to its back.
  void board(const std::array<glm::vec3, 4>& front, glm::vec3 to_back);
  /// Axis-aligned in the frame; low < high on every axis. leave_out: BoxFaces, of no effect where closed() is
  /// asked for.
  void box(glm::vec3 low, glm::vec3 high, uint32_t leave_out = 0);
  /// nu by nv quads over corner + [0, 1] u + [0, 1] v; faces u x v.
  void patch(glm::vec3 corner, glm::vec3 u, glm::vec3 v, uint32_t nu, uint32_t nv);
  /// nu by nv quads of any surface: point(i, j) is called once for each vertex, i = 0..nu, j = 0..nv, and not
  /// at all where only counting. Of leaves: the whole picture, upright along j. closed: column nu is column
  /// 0. Faces d/di x d/dj.
  template <class Point>
  void sheet(uint32_t nu, uint32_t nv, bool closed, Point&& point);
  /// Turns the profile (from bottom to top, outside to the right) about the frame's y axis. sides >= 3.
  /// First and last point may have radius 0 (a pole); an open end stays open.
  void lathe(std::span<const LathePoint> profile, uint32_t sides);
  /// A pipe along the points (2 or more, none twice in a row), with one radius; sides >= 3.
  void tube(std::span<const glm::vec3> path, float radius, uint32_t sides, bool capped);
  /// Same, with a radius for every point.
  void tube(std::span<const glm::vec3> path, std::span<const float> radii, uint32_t sides, bool capped);

  uint64_t vertexCount() const { return size_.vertices; }
  uint64_t triangleCount() const { return size_.allTriangles(); }
  const MeshSize& size() const { return size_; }
  const std::vector<glm::vec3>& positions() const { return positions_; }
  const std::vector<glm::uvec3>& triangles() const { return triangles_; }
  /// Of each triangle; empty where alpha is not asked for.
  const std::vector<Matter>& matters() const { return matters_; }
  /// Of each vertex, where there are leaves; kNoPlace of those that are not theirs. Vertices beyond have
  /// none.
  const std::vector<glm::vec2>& places() const { return places_; }
  static constexpr glm::vec2 kNoPlace{-1};
  void clear();

 private:
  void count(uint64_t vertices, uint64_t triangles);

  bool counting_;
  MeshOptions options_;
  Matter matter_ = Matter::kSolid;
  MeshSize size_;
  std::vector<glm::vec3> positions_;
  std::vector<glm::uvec3> triangles_;
  std::vector<Matter> matters_;
  std::vector<glm::vec2> places_;
};

template <class Point>
void MeshBuilder::sheet(uint32_t nu, uint32_t nv, bool closed, Point&& point) {
  const uint32_t columns = closed ? nu : nu + 1;
  if (counting_) {
    count(uint64_t(columns) * (nv + 1), uint64_t(nu) * nv * 2);
    return;
  }
  const uint32_t first = uint32_t(size_.vertices);
  for (uint32_t j = 0; j <= nv; ++j) {
    for (uint32_t i = 0; i < columns; ++i) {
      vertex(point(i, j), {float(i) / float(nu), 1 - float(j) / float(nv)});
    }
  }
  for (uint32_t j = 0; j < nv; ++j) {
    for (uint32_t i = 0; i < nu; ++i) {
      const uint32_t a = first + j * columns, b = a + columns, k = closed && i + 1 == nu ? 0 : i + 1;
      quad(a + i, a + k, b + k, b + i);
    }
  }
}

}  // namespace sightline

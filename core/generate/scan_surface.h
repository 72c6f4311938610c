#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace sightline {

/// A statue as a scanner sees it: one closed surface on a plinth, of as many triangles as wanted, fine detail
/// with them, each vertex off by scanner noise. Made from the number of a vertex or panel alone, so that it
/// can be written in pieces.
///
/// The vertices are the surface points of a lattice of cubes (nx by ny by nz), which is taken to a sphere,
/// the sphere to a surface of revolution, and that is pushed out along its normals: by less than its radii of
/// curvature, so that it never meets itself.
///
///      +--+--+--+           ___            (  )      turned profile: head, shoulders, waist, foot,
///      |  |  |  |         /     \         /    \     plinth
///      +--+--+--+   ->   |       |   ->   |    |
///      |  |  |  |         \ ___ /        /______\    .
///      +--+--+--+                       |________|
class ScanSurface {
 public:
  /// A rectangle of one side of the lattice: an object of the scene.
  struct Panel {
    std::string name;
    int axis = 0;  ///< which the side crosses
    bool high = false;
    glm::uvec2 first{0}, end{0};  ///< quads along the two axes after `axis`, end not included
  };

  /// triangles: at most so many; fewer by what lies in holes.
  ScanSurface(uint64_t triangles, uint64_t seed, bool holes);

  uint32_t vertexCount() const;
  glm::vec3 position(uint32_t vertex) const;
  /// At most kPanelSide quads along each of its sides.
  const std::vector<Panel>& panels() const { return panels_; }
  uint32_t triangleCount(const Panel& panel) const;
  /// Appends them; counterclockwise from outside.
  void addTriangles(const Panel& panel, std::vector<glm::uvec3>& triangles) const;

  static constexpr uint32_t kPanelSide = 181;  ///< two triangles a quad: less than 2^16

 private:
  struct Hole {
    glm::dvec3 direction;
    double radius;
  };
  glm::uvec3 latticePoint(uint32_t vertex) const;
  uint32_t vertexAt(const glm::uvec3& point) const;
  bool isOpen(const Panel& panel, glm::uvec2 quad) const;
  template <typename Visit>
  void visitQuads(const Panel& panel, Visit&& visit) const;

  glm::uvec3 size_{1};  ///< quads along the lattice's axes
  uint64_t seed_;
  uint32_t octaves_ = 1;
  std::vector<Hole> holes_;
  std::vector<Panel> panels_;
};

}  // namespace sightline

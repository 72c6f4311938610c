#pragma once
// Is every point of every triangle inside one of the leaf boxes that reference the triangle?
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace sightline {

struct CoverageBox {
  glm::vec3 low, high;
};

/// Collects the boxes of all references, then checks that no triangle is missing and that the boxes of each
/// triangle together cover it, splits included.
class CoverageCheck {
 public:
  CoverageCheck(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles)
      : positions_(positions), triangles_(triangles), covered_(triangles.size(), false) {}

  /// id must be in range.
  void add(uint32_t id, const CoverageBox& box);
  /// A complaint, or empty.
  std::string finish();

 private:
  struct Part {
    uint32_t id;
    CoverageBox box;
  };
  bool coversTriangle(uint32_t id, std::span<const Part> parts) const;

  std::span<const glm::vec3> positions_;
  std::span<const glm::uvec3> triangles_;
  std::vector<bool> covered_;  ///< by one box alone
  std::vector<Part> parts_;    ///< boxes that hold only a part of their triangle
};

}  // namespace sightline

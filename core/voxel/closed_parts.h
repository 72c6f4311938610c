#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace sightline {

/// What is inside of a closed surface.
enum class InsideRule {
  kParity,   ///< what a way from far off meets the surface an odd number of times before: no winding needed
  kWinding,  ///< what the surface winds around: its triangles turn alike around a solid; solids may overlap
};

/// An edge at which a surface ends, or at which its winding turns.
struct OpenEdge {
  glm::vec3 from{0}, to{0};
  uint32_t triangle = 0;
  uint32_t object = 0;  ///< in Scene::objects
};

/// Parts of a scene that are closed: they have an inside.
struct ClosedParts {
  uint64_t parts = 0;                  ///< of all objects
  uint64_t closed = 0;                 ///< of them
  std::vector<bool> is_closed;         ///< by triangle: of a closed part
  std::optional<OpenEdge> first_open;  ///< of the lowest triangle that has one
};

/// A part is triangles of one object that hang together by edges; corners in the same place are the same. It
/// is closed if at each of its edges an even number of triangles meet (kParity), or as many run along it one
/// way as the other (kWinding). So triangles without area change nothing: those that close gaps between
/// edges and a corner on them count. Objects are looked at on many threads; the result does not depend on it.
ClosedParts closedParts(const Scene& scene, InsideRule rule);

/// Throws Error that names object and edge if a part is not closed.
void requireClosed(const Scene& scene, const ClosedParts& parts);

/// "closed parts: 3 of 60".
std::string closedText(const ClosedParts& parts);

}  // namespace sightline

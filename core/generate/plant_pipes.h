#pragma once
#include <cstdint>
#include <vector>

#include "core/generate/generator_random.h"
#include "core/generate/mesh_builder.h"

namespace sightline {

/// An axis-aligned region of space.
struct PipeBox {
  glm::vec3 low{0}, high{0};
};

/// Corners of a pipe that runs through `room` along the axes, around `obstacle` (may be empty: low > high).
/// 3 to `legs` + 1 corners; every leg is at least 4 radii long.
std::vector<glm::vec3> routePipe(GeneratorRandom& random, const PipeBox& room, const PipeBox& obstacle,
                                 float radius, uint32_t legs);

/// A pipe along the corners with round bends; higher levels add flanges and their bolts. Level 0: nothing.
void makePipe(MeshBuilder& mesh, const std::vector<glm::vec3>& corners, float radius, uint32_t level);

/// A valve: flanged body on a pipe of this radius along the frame's x axis, spindle and hand wheel upwards.
/// Level 0 and 1: nothing.
void makeValve(MeshBuilder& mesh, float radius, uint32_t level);

inline constexpr uint32_t kPipeLevels = 60;

}  // namespace sightline

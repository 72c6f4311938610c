#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace sightline {

/// What a glTF material says of a triangle's surface.
struct SavedMaterial {
  bool double_sided = true;
  bool glass = false;
  std::optional<uint32_t> mask;  ///< in the scene's masks
  bool operator==(const SavedMaterial&) const = default;
};

/// Triangles of an object that a file holds together: neighbours with the same material.
struct SavedRun {
  uint32_t object = 0;
  uint32_t first_triangle = 0;  ///< as stored
  uint32_t triangle_count = 0;
  size_t material = 0;
  uint32_t first_position = 0;  ///< masked: of its own vertices, within which its triangles count
  uint32_t position_count = 0;  ///< 0: not masked; triangles count within the scene's vertices
};

/// A scene as a glTF file holds it. Vertices of masked triangles have places in an image, and are those of
/// one run alone: they come behind the others.
struct SavedRuns {
  std::vector<SavedMaterial> materials;  ///< in order of first use
  std::vector<uint32_t> masks;           ///< that materials have: in order of first use
  std::vector<SavedRun> runs;            ///< ascending
  // Where triangles are masked, else empty: the scene's own hold.
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  uint32_t shared_positions = 0;  ///< those that no masked run owns
  std::vector<glm::vec2> places;  ///< of the others, in the image: 0..1 from the upper left corner
};
SavedRuns splitIntoRuns(const Scene& scene);

/// Throws Error that begins with `file` for a scene without triangles, and one whose names would not come
/// back as they are.
void checkWritable(const Scene& scene, const std::string& file);

}  // namespace sightline

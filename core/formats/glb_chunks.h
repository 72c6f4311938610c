#pragma once
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/formats/load_scene.h"

namespace sightline {

/// The chunks of a GLB file, in its bytes.
struct GlbChunks {
  std::string_view json;
  std::string_view bin = {};  ///< of the first buffer; data() is null without
  std::vector<std::string> warnings = {};
};

/// Throws Error if the bytes are no whole GLB file of version 2. A total length that is wrong although the
/// chunks are whole, and a second chunk that is not marked as binary, are warnings. name: of the file.
GlbChunks splitGlb(std::string_view bytes, const std::string& name);

/// Where a glTF document stands.
struct GltfWorld {
  glm::dmat4 parent{1.0};  ///< of its roots, to the world
  glm::dvec3 offset{0.0};  ///< taken off the world's coordinates
};

/// The scene of a document. file: its name, for messages and for files beside it. Throws Error, NeedsOffset.
Scene loadGltfDocument(const GlbChunks& chunks, const std::filesystem::path& file,
                       const SceneLoadOptions& options, const GltfWorld& world);

}  // namespace sightline

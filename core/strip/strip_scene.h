#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace sightline {

struct StripOptions {
  /// Of an object of which nothing is seen, the first triangle (OBJ, PLY: face) stays.
  bool keep_objects = false;
  /// Vertices that no triangle uses any more go, too.
  bool compact = false;
  /// As the scene was loaded (SceneLoadOptions).
  std::vector<std::string> ignored_extensions = {};
  bool allow_external = false;
  /// Buffers beside the output may be replaced.
  bool overwrite = false;
};

/// What became of a scene file.
struct StripReport {
  uint64_t triangles = 0;     ///< of the scene that is left; a mesh counts in each place that shows it
  std::vector<bool> kept;     ///< by id: those; the scene that is left has them in this order
  uint64_t objects_gone = 0;  ///< of the scene's: nothing of them is left
  uint64_t bytes_before = 0;  ///< of the file, and of the buffers beside it
  uint64_t bytes = 0;         ///< of the output, and of the buffers that it names
  std::vector<std::filesystem::path> buffers;  ///< written beside the output
  std::vector<std::string> notes;              ///< a line each: what was not touched, and why
};

/// Throws Error where stripScene would for the kinds of both files alone: another kind of output, or a scene
/// of a kind that is not written. For before the work.
void requireStrippable(const std::filesystem::path& file, const std::filesystem::path& out);

/// Writes the scene file `file` without the triangles that are not in `seen` (by id) to `out`, a file of the
/// same kind. What stays, stays in its order, and all else of the file byte for byte:
/// - glTF: new lists of indices for the primitives that lose triangles; strips and fans among them become
///   lists. A mesh that several nodes show keeps what is seen of any of them. A primitive of which nothing is
///   left goes from its mesh; of a mesh of which nothing is left one triangle stays, and no node shows it any
///   more, so that the numbers of meshes and nodes stay. Whole stay: meshes that move (skins, morph targets,
///   animated nodes), that a node outside of the scene shows too, and primitives with extensions that may
///   depend on the order of triangles, compression by Draco among them.
/// - OBJ, PLY: a face stays if any of the triangles that it is cut into is seen.
///
/// scene: of this file, loaded with SceneLoadOptions::faces and without repair. A buffer that lies beside a
/// .gltf file and changes is written beside `out`, under its name: OUT.bin, then OUT-1.bin, ...; nothing that
/// the scene reads is replaced. The files appear when they are whole, `out` last.
/// Throws Error: nothing seen; output of another kind; a file in the way; a file that cannot be written.
StripReport stripScene(const Scene& scene, const std::filesystem::path& file, const std::vector<bool>& seen,
                       const StripOptions& options, const std::filesystem::path& out);

}  // namespace sightline

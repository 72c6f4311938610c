#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/named_triangles.h"
#include "core/pvs/bake_params.h"
#include "core/pvs/cell_pvs.h"

namespace sightline {

/// Latest version of the format. A bake that needs nothing of it is written in version 4 (versionOf).
inline constexpr uint32_t kPvsVersion = 6;

/// All of a .pvs file (docs/pvs-format.md).
struct PvsFile {
  uint32_t version = kPvsVersion;  ///< of the format that it was read from
  uint32_t algorithm = 0;  ///< kAlgorithmRevision (core/gvs/algorithm_revision.h) of the program that baked;
                           ///< 1 for all that wrote older versions of the format
  std::string
      intersector;  ///< intersectorOf the device (core/device/registry/make_device.h): the sets depend on it
  uint64_t scene_hash = 0;
  uint32_t triangle_count = 0;  ///< of the scene
  std::string scene_name;       ///< file name without folder, for people
  std::string device;           ///< on which the bake began: that of the first cell; empty before it
  BakeParams params;
  glm::dvec3 offset{0.0};      ///< Scene::offset: cells and witnesses are less this, the scene's file is not
  bool has_witnesses = false;  ///< every cell has one witness a triangle
  /// Objects that open: closed in the cells' sets, hiding nothing in what their open sets add. Ascending,
  /// disjoint.
  std::vector<NamedTriangles> doors;
  /// Objects that are seen but hide nothing. Likewise.
  std::vector<NamedTriangles> see_through;
  std::vector<ViewCell> planned;  ///< all cells of the bake, in order; cells holds the first of them
  std::vector<CellPvs> cells;     ///< baked so far; complete when as many as planned
};

/// What is in a file is no bake that this program can use: another kind of file, another version of the
/// format, or damaged. Baking again helps; reading again does not.
class BadPvs : public Error {
 public:
  using Error::Error;
};

/// Reads and checks everything: magic, version, sizes, checksums, cells, ids in range and ascending. Throws
/// BadPvs (file, offset, what was expected), or Error if the file cannot be read.
PvsFile loadPvs(const std::filesystem::path& file);

/// The version in which a bake is written: the oldest that can hold it.
uint32_t versionOf(const PvsFile& pvs);

/// Writes to a temporary name beside it, flushes to disk and renames; each pvs.cells with its device. In
/// pvs.version's stead it writes versionOf(pvs). Throws Error.
void savePvs(const PvsFile& pvs, const std::filesystem::path& file);

}  // namespace sightline

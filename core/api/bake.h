#pragma once
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "core/api/session.h"
#include "core/bake/bake_events.h"
#include "core/base/named_triangles.h"
#include "core/cell/view_cell.h"
#include "core/pvs/pvs_file.h"

namespace sightline {

/// Whether a bake keeps a ray for each triangle that hits it first: 28 bytes a triangle.
enum class Witnesses { kDrop, kKeep };

/// What a bake holds besides plain sets.
struct BakeContent {
  BakeContent(Witnesses to_keep = Witnesses::kDrop, std::vector<NamedTriangles> that_open = {})
      : witnesses(to_keep), doors(std::move(that_open)) {}

  Witnesses witnesses;
  /// Objects that open (findObjects in core/scene/find_objects.h): each cell gets a second set, of what it
  /// sees besides when they hide nothing, and is baked twice. Needs the memory of two sessions.
  std::vector<NamedTriangles> doors;
};

/// Computes the set of each cell on the session's device, one cell after the other, in memory. Equal scene,
/// cells and parameters give equal sets, bit for bit, whatever the number of threads, on "cpu" and every
/// "opencl" device. Opens the session.
///
/// cells: at least one, each sound (cellProblem), no name twice; in the coordinates of the scene's
/// file: Scene::offset is taken off them, and off the cells that are returned.
/// Returns all cells; when *events.stop became true, those finished by then: fewer cells than planned.
/// Throws Error that names what is wrong with cells or parameters before any work, or what failed; nothing is
/// returned then.
PvsFile bake(Session& session, std::span<const ViewCell> cells, const BakeParams& params = {},
             const BakeEvents& events = {}, const BakeContent& content = {});

/// Where a bake goes and what it keeps.
struct BakeOutput {
  std::filesystem::path file = {};  ///< FILE.part is beside it until all cells are there
  BakeContent content = {};
  bool overwrite = false;  ///< replace a bake with other inputs, in FILE or FILE.part
};

/// The same into a .pvs file that loadPvs reads. Each finished cell is on the disk at once: a bake that was
/// stopped or killed goes on after its finished cells when it is called again; one that is complete is left
/// as it is, without opening the session. False if *events.stop became true before all cells were baked.
/// Throws Error, also if the file holds a bake with other inputs, or another process bakes into it.
bool bakeToFile(Session& session, std::span<const ViewCell> cells, const BakeOutput& output,
                const BakeParams& params = {}, const BakeEvents& events = {});

}  // namespace sightline

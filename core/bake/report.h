#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bvh/bvh.h"
#include "core/base/named_triangles.h"
#include "core/device/device.h"
#include "core/gvs/leaks.h"
#include "core/pvs/cell_summary.h"
#include "core/scene/cell_check.h"
#include "core/scene/scene.h"

namespace sightline {

/// Facts about the scene's tree.
struct TreeSummary {
  double build_seconds = 0;
  double sah_cost = 0;
  uint32_t depth = 0;
  uint64_t nodes2 = 0, nodes8 = 0;
  uint64_t references = 0;
  uint64_t bytes = 0;  ///< nodes of both layouts and references
};
TreeSummary summarize(const Bvh& bvh);

/// Facts about the scene.
struct SceneSummary {
  std::string name;
  uint64_t hash = 0;
  uint64_t triangles = 0, vertices = 0, objects = 0;
  uint64_t degenerate = 0, repaired = 0, alpha = 0, glass = 0, single_sided = 0, hidden_nodes = 0;
  uint64_t opaque_masks = 0;          ///< triangles whose masks were loaded as opaque
  SurfaceCounts surfaces;             ///< what rays meet that does not simply end them
  std::vector<std::string> warnings;  ///< of loading (Scene)
  glm::dvec3 offset{0.0};             ///< of the scene
  uint64_t instances = 0;             ///< 0: the scene is traced as plain triangles
  uint64_t stored_triangles = 0;      ///< in the scene and its tree
};
SceneSummary summarize(const Scene& scene, const std::string& name, uint64_t hash);

/// Everything that the JSON report of a bake says.
struct BakeReport {
  std::string version;  ///< of the program
  SceneSummary scene;
  std::string baked_on;              ///< device on which the bake began
  std::optional<DeviceInfo> device;  ///< none: the file was complete, no device was opened
  std::optional<TreeSummary> tree;   ///< as device
  std::string set;                   ///< "array" or "hash"; empty without a device
  bool spatial_splits = false, witnesses = false, repair = false;
  std::vector<std::string> ignored_extensions;  ///< as the scene was loaded
  BakeParams params;
  std::vector<CellSummary> cells;                  ///< finished, in order
  std::vector<std::vector<CellWarning>> warnings;  ///< checkCells of all planned cells; empty: not checked
  std::vector<std::optional<Leaks>> leaks;         ///< of `cells`, as far as this run baked them and looked
  std::vector<uint64_t> bounds;             ///< of `cells`: triangles not proved hidden; empty: no bound
  std::vector<NamedTriangles> see_through;  ///< of the bake, too
  std::vector<NamedTriangles> doors;        ///< of the bake
  uint64_t planned_cells = 0;
  uint64_t resumed_cells = 0;       ///< of `cells`: baked by an earlier run
  double seconds = 0;               ///< of this run: loading, tree, cells
  uint64_t peak_process_bytes = 0;  ///< most memory that this process held
};

/// What is to be said against the finished cell `index`, its set's size included; mostly nothing.
std::vector<CellWarning> warningsOf(const BakeReport& report, size_t index);

/// The JSON text, keys as docs/report.md says.
std::string reportJson(const BakeReport& report);

/// A line each for what is traced as something simpler than the file says (masks as opaque, single-sided as
/// two-sided, each only by the options of loading), for nodes left out, and for each warning of loading;
/// empty if there is nothing.
std::vector<std::string> sceneWarnings(const SceneSummary& scene);

/// What there is to say about the leaks of a cell, after its name; empty: nothing.
std::string leaksText(const Leaks& leaks);

/// Most memory that this process has held, in bytes (VmHWM).
uint64_t peakProcessBytes();

}  // namespace sightline

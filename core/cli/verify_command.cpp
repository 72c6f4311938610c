#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>

#include "core/api/bake_steps.h"
#include "core/bake/require_scene.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/bound_states.h"
#include "core/cli/commands.h"
#include "core/cli/doors_option.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/overwrite.h"
#include "core/cli/rounding_option.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "core/pvs/pvs_writer.h"
#include "core/scene/scene_tree.h"
#include "core/verify/bound_leaks.h"
#include "core/verify/verify.h"

namespace sightline {
namespace {

struct VerifyCommand {
  std::filesystem::path scene, pvs, output, report, bound;
  VerifyOptions options;
  uint64_t max_disproved = 0;
  double min_proven = 0.9999;
  SceneLoadOptions load;
  bool overwrite = false;
  DoorState doors = DoorState::kClosed;
};

std::string reportText(const VerifyCommand& command, const PvsFile& pvs, const std::vector<CellProofs>& cells,
                       const std::vector<BoundLeaks>& leaks) {
  Json json = {
      {"sightline", SL_VERSION},
      {"scene",
       {{"name", pvs.scene_name}, {"hash", hashText(pvs.scene_hash)}, {"triangles", pvs.triangle_count}}},
      {"device", pvs.device},
      {"rounding_steps", command.options.rounding.steps},
      {"cells", verifyJson(cells)}};
  if (!command.bound.empty()) json["bound"] = boundLeaksJson(leaks);
  return jsonText(json);
}

/// Writes the sets with better witnesses and without what is disproved.
void writeBetter(const VerifyCommand& command, PvsFile& pvs, PvsFile& baked,
                 const std::vector<CellProofs>& cells) {
  uint64_t removed = 0;
  for (size_t i = 0; i < cells.size(); ++i) {
    removed += cells[i].counts[size_t(Proof::kDisproved)];
    removeDisproved(cells[i], pvs.cells[i]);
    baked.cells[i].triangles = std::move(pvs.cells[i].triangles);
    baked.cells[i].witnesses = std::move(pvs.cells[i].witnesses);
  }
  savePvs(baked, command.output);
  if (removed == 0) return;
  fmt::print("{}: {} {} left out\n", command.output.string(), counted(removed, "disproved triangle"),
             removed == 1 ? "is" : "are");
}

/// What of the sets is not in their bounds. With better witnesses, where there are.
std::vector<BoundLeaks> leaksOf(const Judge& judge, const Scene& scene, const PvsFile& pvs,
                                const PvsFile& bound) {
  const BoundScene voxels = makeBoundScene(scene, {.lattice = latticeOf(double(bound.params.bound))});
  std::vector<BoundLeaks> leaks;
  for (const CellPvs& cell : pvs.cells) {
    leaks.push_back(findBoundLeaks(judge, voxels, cell, findCell(bound, cell.cell.name).triangles));
    fmt::print("{}: {}\n", cell.cell.name,
               statesText(cell.triangles.size(), findCell(bound, cell.cell.name).triangles.size(),
                          pvs.triangle_count));
  }
  std::fputs(boundLeaksText(leaks).c_str(), stdout);
  return leaks;
}

/// Says whether the result is past the limits.
bool pastLimits(const VerifyCommand& command, const std::vector<CellProofs>& cells) {
  CellProofs all;
  for (const CellProofs& cell : cells) {
    for (uint32_t i = 0; i < kProofs; ++i) all.counts[i] += cell.counts[i];
  }
  const uint64_t disproved = all.counts[size_t(Proof::kDisproved)];
  fmt::print("{:.5f} % of the witnesses prove their triangle, {} are disproved\n", 100 * all.provenShare(),
             disproved);
  if (disproved > command.max_disproved) {
    fmt::print("past the limit: {} disproved, at most {} allowed\n", disproved, command.max_disproved);
  }
  if (all.provenShare() < command.min_proven) {
    fmt::print("past the limit: {:.7f} proven, at least {} wanted\n", all.provenShare(), command.min_proven);
  }
  return disproved > command.max_disproved || all.provenShare() < command.min_proven;
}

void run(const VerifyCommand& command) {
  if (command.doors == DoorState::kOpen && !command.output.empty()) {
    throw Error("--output: better sets can be written with the doors closed only", kExitUsage);
  }
  requireSeparate(std::array{command.output, command.report},
                  std::array{command.scene, command.pvs, command.bound});
  if (!command.output.empty()) {
    requireNew(command.output, command.overwrite);
    OutputFile probe(command.output);  // fail before the work, not after it
  }
  const TextOutputs outputs({&command.report, 1});
  PvsFile baked = loadFinishedCells(command.pvs);
  PvsFile pvs = inState(baked, command.doors, command.pvs);
  if (!pvs.has_witnesses) {
    throw Error(fmt::format("{}: has no witnesses; bake it with --witnesses", command.pvs.string()));
  }
  PvsFile bound;
  if (!command.bound.empty()) {
    bound = loadPvs(command.bound);
    requireBound(bound, pvs, command.bound);  // refuses before the work
  }
  Scene loaded = loadScene(command.scene, command.load);
  requireScene(pvs, loaded, command.pvs);
  const Scene scene = inState(std::move(loaded), baked, command.doors);
  const Bvh bvh = buildSceneTree(scene);
  const Judge judge(scene, bvh);
  std::vector<CellProofs> cells;
  for (CellPvs& cell : pvs.cells) cells.push_back(verifyCell(judge, scene, cell, command.options));
  std::fputs(verifyTable(cells).c_str(), stdout);
  std::vector<BoundLeaks> leaks;
  if (!command.bound.empty()) leaks = leaksOf(judge, scene, pvs, bound);
  if (!command.report.empty()) outputs.save(reportText(command, pvs, cells, leaks), command.report);
  if (!command.output.empty()) writeBetter(command, pvs, baked, cells);
  const bool is_wrong =
      std::ranges::any_of(leaks, [](const BoundLeaks& l) { return !l.unexplained.empty(); });
  if (pastLimits(command, cells) || is_wrong) throw ExitCode{kExitPastLimit};
}

}  // namespace

void addVerifyCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("verify", "Prove that each triangle of a bake is seen, by exact rays");
  const auto options = std::make_shared<VerifyCommand>();
  command->add_option("scene", options->scene, "the scene that was baked")->required()->type_name("SCENE");
  command->add_option("pvs", options->pvs, "made by bake --witnesses")->required()->type_name("OUT.pvs");
  command
      ->add_option("-o,--output", options->output,
                   "write the sets with better witnesses, without what is disproved")
      ->check(notStandardOutput("a .pvs file"))
      ->type_name("NEW.pvs");
  command
      ->add_option("--report", options->report,
                   "write all that is not proven as JSON (docs/report.md); - is standard output")
      ->type_name("R.json");
  command
      ->add_option("--bound", options->bound,
                   "made by bound of the same cells: list what of the sets is outside of it, each with an "
                   "exact ray and where that enters an opaque voxel; exit code 3 if one does not")
      ->type_name("UPPER.pvs");
  command
      ->add_option("--max-disproved", options->max_disproved,
                   "exit code 3 for more triangles disproved than this")
      ->transform(wholeNumber())
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--min-proven", options->min_proven, "exit code 3 for a smaller share proven than this")
      ->check(between(0, 1))
      ->type_name("SHARE")
      ->capture_default_str();
  declareDoors(*command, options->doors);
  declareRounding(*command, options->options.rounding);
  command->add_flag("--overwrite", options->overwrite, "replace NEW.pvs");
  declareLoading(*command, options->load, kAsBakeDid);
  command->callback([options] { run(*options); });
}

}  // namespace sightline

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>

#include "core/bake/require_scene.h"
#include "core/base/error.h"
#include "core/base/text.h"
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
#include "core/verify/verify.h"

namespace sightline {
namespace {

struct VerifyCommand {
  std::filesystem::path scene, pvs, output, report;
  VerifyOptions options;
  uint64_t max_disproved = 0;
  double min_proven = 0.9999;
  SceneLoadOptions load;
  bool overwrite = false;
  DoorState doors = DoorState::kClosed;
};

std::string reportText(const VerifyCommand& command, const PvsFile& pvs,
                       const std::vector<CellProofs>& cells) {
  const Json json = {
      {"sightline", SL_VERSION},
      {"scene",
       {{"name", pvs.scene_name}, {"hash", hashText(pvs.scene_hash)}, {"triangles", pvs.triangle_count}}},
      {"device", pvs.device},
      {"rounding_steps", command.options.rounding.steps},
      {"cells", verifyJson(cells)}};
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
  requireSeparate(std::array{command.output, command.report}, std::array{command.scene, command.pvs});
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
  Scene loaded = loadScene(command.scene, command.load);
  requireScene(pvs, loaded, command.pvs);
  const Scene scene = inState(std::move(loaded), baked, command.doors);
  const Bvh bvh = buildSceneTree(scene);
  const Judge judge(scene, bvh);
  std::vector<CellProofs> cells;
  for (CellPvs& cell : pvs.cells) cells.push_back(verifyCell(judge, scene, cell, command.options));
  std::fputs(verifyTable(cells).c_str(), stdout);
  if (!command.report.empty()) outputs.save(reportText(command, pvs, cells), command.report);
  if (!command.output.empty()) writeBetter(command, pvs, baked, cells);
  if (pastLimits(command, cells)) throw ExitCode{kExitPastLimit};
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

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/api/bake_steps.h"
#include "core/api/session_parts.h"
#include "core/bake/bake.h"
#include "core/base/interrupted.h"
#include "core/base/text.h"
#include "core/bound/bound_cell.h"
#include "core/cli/bound_voxels.h"
#include "core/cli/commands.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/share_line.h"
#include "core/cli/stop_signal.h"
#include "core/cli/text_outputs.h"
#include "core/cli/voxel_options.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "core/scene/find_objects.h"
#include "core/verify/bound_leaks.h"

namespace sightline {
namespace {

struct BoundArguments {
  std::filesystem::path scene, cells, output, voxels, leaks;
  VoxelSize size;
  uint64_t rays = 1'000'000;
  std::vector<std::string> see_through;
  bool overwrite = false;
  SceneLoadOptions load;
};

/// What is written: the bake of these cells by the method bound.
PvsFile boundInputs(Session& session, const BoundArguments& arguments, const Lattice& lattice) {
  PvsFile inputs = bakeInputs(session, loadCells(arguments.cells), {}, {});
  inputs.params.method = Method::kBound;
  inputs.params.bound = float(lattice.voxelSize());
  inputs.version = versionOf(inputs);
  return inputs;
}

void sayCell(const CellPvs& pvs, uint64_t opaque, uint32_t all) {
  const uint64_t hidden = all - pvs.triangles.size();
  if (opaque == 0) {
    fmt::print(
        "{}: nothing is proved, as no voxel is opaque: all space without triangles is reached from the "
        "cell. {}\n",
        pvs.cell.name,
        hidden == 0 ? "All triangles may be seen"
                    : fmt::format("{} of {} triangles are behind it", hidden, all));
  } else {
    fmt::print("{}: {} of {} triangles may be seen, {} ({:.1f} %) are proved hidden, {}\n", pvs.cell.name,
               pvs.triangles.size(), all, hidden, 100 * double(hidden) / double(all),
               shortDuration(pvs.stats.seconds));
  }
  std::fflush(stdout);
}

BoundScene voxelsOf(const BoundArguments& arguments, Session& session, std::optional<VoxelGrid>&& read,
                    const Lattice& lattice, const StopSignal& stop) {
  ShareLine status("voxelised");
  const VoxelizeOptions options{
      .lattice = lattice,
      .with_triangles = false,
      .progress = [&](double done,
                      uint64_t voxels) { status.show(done, [&] { return shortCount(voxels) + " voxels"; }); },
      .stop = stop.flag()};
  BoundScene scene = read ? makeBoundScene(session.scene(), std::move(*read), options)
                          : makeBoundScene(session.scene(), options);
  status.end();
  fmt::print("{}: {} voxels of {:g}\n", arguments.scene.string(), scene.all.count(), lattice.voxelSize());
  return scene;
}

CellBaker boundBaker(const BoundScene& voxels, const StopSignal& stop) {
  return [&](const ViewCell& cell, uint32_t, const ProgressCallback&) {
    const auto start = std::chrono::steady_clock::now();
    ShareLine status(cell.name);
    BoundOptions options;
    options.progress = [&](double done) { status.show(done, [] { return std::string("looked at"); }); };
    options.stop = stop.flag();
    CellBound bound = boundCell(voxels, cell, options);
    status.end();
    CellPvs pvs;
    pvs.cell = cell;
    pvs.triangles = std::move(bound.triangles);
    pvs.stats.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    sayCell(pvs, bound.opaque_voxels, voxels.scene.triangleCount());
    return pvs;
  };
}

/// What random rays see beyond the bound.
void writeLeaks(const BoundArguments& arguments, Session& session, const BoundScene& voxels,
                const TextOutputs& outputs, const StopSignal& stop) {
  const PvsFile bound = loadPvs(arguments.output);
  BakeParams params;
  params.method = Method::kRandom;
  params.n_rand = uint32_t(arguments.rays);
  params.max_rays = arguments.rays;
  params.validation_rays = 0;
  std::vector<ViewCell> cells = moved(bound.planned, session.scene().offset);
  BakeEvents events;
  events.stop = stop.flag();
  const PvsFile seen = bake(session, cells, params, events, BakeContent(Witnesses::kKeep));
  if (stop.exitCode() != 0) throw Interrupted();
  const Judge judge(session.scene(), session.parts().tree());
  std::vector<BoundLeaks> leaks;
  for (size_t i = 0; i < seen.cells.size(); ++i) {
    leaks.push_back(findBoundLeaks(judge, voxels, seen.cells[i], bound.cells[i].triangles));
  }
  std::fputs(boundLeaksText(leaks).c_str(), stdout);
  const Json json = {{"sightline", SL_VERSION},
                     {"scene", {{"name", bound.scene_name}, {"triangles", bound.triangle_count}}},
                     {"bound", bound.params.bound},
                     {"rays", arguments.rays},
                     {"cells", boundLeaksJson(leaks)}};
  outputs.save(jsonText(json), arguments.leaks);
}

void run(const BoundArguments& arguments) {
  requireSeparate(std::array{arguments.output, partFileOf(arguments.output), arguments.leaks},
                  std::array{arguments.scene, arguments.cells, arguments.voxels});
  const TextOutputs outputs({&arguments.leaks, 1});
  Scene loaded = loadScene(arguments.scene, arguments.load);
  SessionOptions session_options;
  session_options.see_through = findObjects(loaded, arguments.see_through, "--see-through");
  session_options.scene_name = arguments.scene.filename().string();
  Session session(std::move(loaded), std::move(session_options));
  std::optional<VoxelGrid> read;
  if (!arguments.voxels.empty()) read = loadBoundVoxels(arguments.voxels, session.sceneHash());
  const Lattice lattice = read ? read->lattice : arguments.size.of(session.scene());
  Bake bake(boundInputs(session, arguments, lattice), arguments.output, arguments.overwrite);
  if (bake.complete()) {
    fmt::print("{}: already complete, nothing to prove (--overwrite proves again)\n",
               arguments.output.string());
    if (arguments.leaks.empty()) return;
  }
  const StopSignal stop;
  try {
    const BoundScene voxels = voxelsOf(arguments, session, std::move(read), lattice, stop);
    BakeEvents events;
    events.stop = stop.flag();
    if (!bake.complete() && !bake.run("cpu, exact voxels", boundBaker(voxels, stop), events))
      throw Interrupted();
    if (!arguments.leaks.empty()) writeLeaks(arguments, session, voxels, outputs, stop);
  } catch (const Interrupted&) {
    fmt::print("stopped: {} of {} cells are kept; the same command goes on after them\n",
               bake.finished().size(), bake.head().planned.size());
    throw ExitCode{stop.exitCode()};
  }
}

constexpr const char* kBoundFooter =
    "The file holds, for each cell, the triangles that are not proved hidden. A voxel\n"
    "that no triangle meets, and to which no path of such voxels leads from the\n"
    "cell, is opaque; a triangle is hidden if all segments from the cell to it pass\n"
    "opaque voxels. What is seen all the same is seen through gaps narrower than a\n"
    "voxel. Open sheets, such as levels without outer walls, have no opaque voxels,\n"
    "and nothing is proved.\n\n"
    "Examples:\n"
    "  sightline bound city.glb --cells cells.json --voxel 0.5 -o upper.pvs\n"
    "  sightline bake city.glb --cells cells.json --bound upper.pvs -o city.pvs\n";

}  // namespace

void addBoundCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bound", "Prove by voxels what view cells cannot see");
  const auto a = std::make_shared<BoundArguments>();
  command->add_option("SCENE", a->scene, "Scene file: .obj, .gltf, .glb or .ply")->required();
  command->add_option("--cells", a->cells, "View cells, JSON")->required()->type_name("CELLS.json");
  command->add_option("-o,--output", a->output, "What may be seen; .part is added until it is whole")
      ->required()
      ->check(notStandardOutput("a .pvs file"))
      ->type_name("UPPER.pvs");
  command->add_option("--voxels", a->voxels, "Voxels of the scene, made by sightline voxels")
      ->type_name("SCENE.slv");
  a->size.declare(*command);
  for (const char* size : {"--voxel", "--along"})
    command->get_option("--voxels")->excludes(command->get_option(size));
  CLI::Option* leaks =
      command
          ->add_option("--leaks", a->leaks,
                       "Write what random rays see beyond the bound as JSON; - is standard output")
          ->type_name("LEAKS.json");
  command->add_option("--rays", a->rays, "For --leaks: random rays of each cell")
      ->needs(leaks)
      ->transform(wholeNumber(1, 1'000'000'000))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--see-through", a->see_through,
                   "Objects that hide nothing, by name (* any letters, ? one; repeated), as in bake")
      ->allow_extra_args(false)
      ->type_name("PATTERN");
  command->add_flag("--overwrite", a->overwrite, "Replace UPPER.pvs if it is of other inputs");
  declareLoading(*command, a->load);
  command->footer(kBoundFooter);
  command->callback([a] { run(*a); });
}

}  // namespace sightline

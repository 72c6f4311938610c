#include <fmt/core.h>

#include <array>
#include <memory>
#include <optional>

#include "core/api/session_parts.h"
#include "core/bake/require_scene.h"
#include "core/bake/status_line.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/device_check.h"
#include "core/cli/doors_option.h"
#include "core/cli/export_voxels.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/stop_signal.h"
#include "core/cli/text_outputs.h"
#include "core/export/export.h"
#include "core/export/objects_json.h"
#include "core/formats/load_scene.h"
#include "core/formats/obj_text.h"
#include "core/formats/save_scene.h"
#include "core/io/file_io.h"
#include "core/pvs/choose_cell.h"
#include "core/pvs/pvs_writer.h"
#include "core/voxel/voxel_file.h"

namespace sightline {
namespace {

struct ExportOptions {
  std::filesystem::path pvs, out, scene;
  std::string cell, format;
  SceneLoadOptions load;
  DoorState doors = DoorState::kClosed;
  uint32_t rays = 1'000'000;  ///< of each cell, and below: for objects
  double least = 0;
  std::string device = "opencl";
  uint32_t level = 0;  ///< and below: for voxels
  bool merge = false;
};

/// What cells see in terms of the scene's objects, all of them in one file.
void exportObjects(const ExportOptions& options, const TextOutputs& outputs) {
  if (!options.cell.empty()) {
    throw Error("--cell: --format objects is of all cells; leave it out", kExitUsage);
  }
  const PvsFile baked = loadFinishedCells(options.pvs);
  const PvsFile pvs = inState(baked, options.doors, options.pvs);
  Scene loaded = loadScene(options.scene, options.load);
  requireScene(pvs, loaded, options.pvs);
  Session session(inState(std::move(loaded), baked, options.doors), {.device = options.device});
  const StopSignal stop;
  StatusLine status;
  std::vector<ObjectHits> hits;
  for (uint32_t i = 0; i < pvs.cells.size() && stop.exitCode() == 0; ++i) {
    status.show([&] { return fmt::format("objects: cell {} of {}", i + 1, pvs.cells.size()); });
    hits.push_back(countObjectHits(session.parts().tracer(), session.scene(), pvs.cells[i].cell, i,
                                   pvs.params.seed, options.rays));
  }
  status.end();
  if (stop.exitCode() != 0) {
    fmt::print("stopped: nothing is written\n");
    throw ExitCode{stop.exitCode()};
  }
  outputs.save(objectsJson(pvs, session.scene(), hits, options.rays, options.least), options.out);
  fmt::print("{}: objects of {}\n", options.out.string(), counted(hits.size(), "cell"));
}

/// saveScene goes by the extension, so it must say the same as --format.
void requireExtension(const ExportOptions& options) {
  if (lowerExtension(options.out) == "." + options.format) return;
  throw Error(fmt::format("{}: must end with .{} for --format {}", options.out.string(), options.format,
                          options.format),
              kExitUsage);
}

/// What only sets, or only voxels, have.
void requireFits(const ExportOptions& options, bool voxels) {
  const std::string& format = options.format;
  if (voxels && (format == "ids" || format == "json" || format == "objects")) {
    throw Error(fmt::format("{}: --format {} is of sets; voxels are written as glb, obj, ply or vdb",
                            options.pvs.string(), format),
                kExitUsage);
  }
  if (voxels && (!options.cell.empty() || !options.scene.empty())) {
    throw Error(fmt::format("{}: {} is of sets, not of voxels; leave it out", options.pvs.string(),
                            options.cell.empty() ? "--scene" : "--cell"),
                kExitUsage);
  }
  if (voxels && isStandardOutput(options.out)) {
    throw Error("--output: - is standard output, where voxels cannot go; give it a name", kExitUsage);
  }
  if (!voxels && (format == "ply" || format == "vdb")) {
    throw Error(fmt::format("{}: --format {} is of voxels (.slv)", options.pvs.string(), format), kExitUsage);
  }
  if (!voxels && (options.level != 0 || options.merge)) {
    throw Error(fmt::format("{}: {} is of voxels (.slv); leave it out", options.pvs.string(),
                            options.merge ? "--merge" : "--level"),
                kExitUsage);
  }
}

void runExport(const ExportOptions& options) {
  const bool voxels = isVoxelFile(options.pvs);
  requireFits(options, voxels);
  if (voxels) {
    requireExtension(options);
    requireSeparate(std::array{options.out}, std::array{options.pvs});
    return exportVoxels({options.pvs, options.out, options.format, options.level, options.merge});
  }
  const bool geometry = options.format == "obj" || options.format == "glb";
  const bool to_output = isStandardOutput(options.out);
  if (to_output && options.format == "glb") {
    throw Error("--output: - is standard output, where a .glb file cannot go; give it a name", kExitUsage);
  }
  if (geometry && !to_output) requireExtension(options);
  const bool objects = options.format == "objects";
  if ((geometry || objects) && options.scene.empty()) {
    throw Error(
        fmt::format("--format {} needs --scene: a .pvs file holds ids, not triangles", options.format),
        kExitUsage);
  }
  if (!objects && options.cell.empty()) throw Error("--cell is required", kExitUsage);
  requireSeparate(std::array{options.out}, std::array{options.pvs, options.scene});
  const TextOutputs outputs({&options.out, 1});
  if (objects) return exportObjects(options, outputs);
  const PvsFile pvs = inState(loadFinishedCells(options.pvs), options.doors, options.pvs);
  const CellPvs& cell = chooseCell(pvs, options.cell, options.pvs);
  std::optional<Scene> scene;
  if (!options.scene.empty()) {
    scene = loadScene(options.scene, options.load);
    requireScene(pvs, *scene, options.pvs);
  }
  if (options.format == "ids") outputs.save(idsText(cell), options.out);
  if (options.format == "json") outputs.save(cellJson(pvs, cell, scene ? &*scene : nullptr), options.out);
  if (geometry && to_output) {
    writeObj(visibleScene(*scene, cell), "standard output",
             [&](std::string_view piece) { outputs.write(piece); });
  } else if (geometry) {
    saveScene(visibleScene(*scene, cell), options.out);
  }
  std::fputs(fmt::format("{}: {} triangles of cell {}\n", options.out.string(), cell.triangles.size(),
                         cell.cell.name)
                 .c_str(),
             stdout);
}

}  // namespace

void addExportCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("export", "Write sets, or voxels, for other programs");
  const auto options = std::make_shared<ExportOptions>();
  command->add_option("pvs", options->pvs, "a bake, or the .part of one in work; or voxels (.slv)")
      ->required()
      ->type_name("OUT.pvs|VOXELS.slv");
  command
      ->add_option("--cell", options->cell,
                   "its name, or its number from 0; not for objects, which are of all")
      ->type_name("NAME|INDEX");
  command
      ->add_option(
          "--format", options->format,
          "ids, obj, glb or json of one cell, or objects: what all cells see of the scene's objects, and how "
          "much of the view each takes (docs/report.md); of voxels glb, obj or ply (their faces), or vdb")
      ->required()
      ->check(oneOf({"ids", "obj", "glb", "json", "objects", "ply", "vdb"}))
      ->type_name("FORMAT");
  command->add_option("-o,--output", options->out, "- is standard output, but for glb and voxels")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--scene", options->scene,
                   "the baked scene: for obj, glb and objects, and for json's objects")
      ->type_name("SCENE");
  declareLoading(*command, options->load, kAsBakeDid);
  declareDoors(*command, options->doors);
  const char* const group = "For --format objects";
  command->add_option("--rays", options->rays, "random rays of each cell, which share the view among objects")
      ->transform(wholeNumber(1, kMostObjectRays))
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  command->add_option("--least", options->least, "leave out objects that take a smaller share of the view")
      ->check(between(0.0, 1.0))
      ->type_name("SHARE")
      ->capture_default_str()
      ->group(group);
  command->add_option("--device", options->device, "that traces them: cpu, opencl or vulkan")
      ->check(deviceName())
      ->type_name("NAME")
      ->capture_default_str()
      ->group(group);
  const char* const of_voxels = "For voxels";
  command->add_option("--level", options->level, "of the file's levels, 0 the finest")
      ->transform(wholeNumber(0, 31))
      ->type_name("N")
      ->capture_default_str()
      ->group(of_voxels);
  command
      ->add_flag(
          "--merge", options->merge,
          "glb, obj and ply: faces side by side as one, in each block; corners then lie on edges of others")
      ->group(of_voxels);
  command->callback([options] { runExport(*options); });
}

}  // namespace sightline

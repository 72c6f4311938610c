#include <fmt/core.h>

#include <array>
#include <memory>
#include <optional>

#include "core/bake/require_scene.h"
#include "core/base/error.h"
#include "core/cli/commands.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/text_outputs.h"
#include "core/export/export.h"
#include "core/formats/load_scene.h"
#include "core/formats/obj_text.h"
#include "core/formats/save_scene.h"
#include "core/io/file_io.h"
#include "core/pvs/choose_cell.h"
#include "core/pvs/pvs_writer.h"

namespace sightline {
namespace {

struct ExportOptions {
  std::filesystem::path pvs, out, scene;
  std::string cell, format;
  SceneLoadOptions load;
};

/// saveScene goes by the extension, so it must say the same as --format.
void requireExtension(const ExportOptions& options) {
  if (lowerExtension(options.out) == "." + options.format) return;
  throw Error(fmt::format("{}: must end with .{} for --format {}", options.out.string(), options.format,
                          options.format),
              kExitUsage);
}

void runExport(const ExportOptions& options) {
  const bool geometry = options.format == "obj" || options.format == "glb";
  const bool to_output = isStandardOutput(options.out);
  if (to_output && options.format == "glb") {
    throw Error("--output: - is standard output, where a .glb file cannot go; give it a name", kExitUsage);
  }
  if (geometry && !to_output) requireExtension(options);
  if (geometry && options.scene.empty()) {
    throw Error(
        fmt::format("--format {} needs --scene: a .pvs file holds ids, not triangles", options.format),
        kExitUsage);
  }
  requireSeparate(std::array{options.out}, std::array{options.pvs, options.scene});
  const TextOutputs outputs({&options.out, 1});
  const PvsFile pvs = loadFinishedCells(options.pvs);
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
  CLI::App* command = app.add_subcommand("export", "Write one cell's set for other programs");
  const auto options = std::make_shared<ExportOptions>();
  command->add_option("pvs", options->pvs, "a bake, or the .part of one in work")
      ->required()
      ->type_name("OUT.pvs");
  command->add_option("--cell", options->cell, "its name, or its number from 0")
      ->required()
      ->type_name("NAME|INDEX");
  command->add_option("--format", options->format, "ids, obj, glb or json")
      ->required()
      ->check(oneOf({"ids", "obj", "glb", "json"}))
      ->type_name("FORMAT");
  command->add_option("-o,--output", options->out, "- is standard output, but for glb")
      ->required()
      ->type_name("FILE");
  command->add_option("--scene", options->scene, "the baked scene: for obj and glb, and for json's objects")
      ->type_name("SCENE");
  declareLoading(*command, options->load, kAsBakeDid);
  command->callback([options] { runExport(*options); });
}

}  // namespace sightline

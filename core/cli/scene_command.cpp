#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <memory>

#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/help_format.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/overwrite.h"
#include "core/cli/share_line.h"
#include "core/formats/cells_file.h"
#include "core/formats/obj_text.h"
#include "core/formats/save_scene.h"
#include "core/formats/walk_file.h"
#include "core/generate/generate.h"
#include "core/io/file_io.h"

namespace sightline {
namespace {

struct SceneArguments {
  std::string name;
  std::string output;
  std::string cells;
  std::string walk;
  uint32_t frames = 3000;
  uint64_t triangles = 2'000'000;
  uint64_t seed = 1;
  uint32_t kinds = 0;  ///< 0: nothing repeats
  SceneExtras extras;
  bool overwrite = false;
};

void printSize(const std::string& file, uint32_t triangles, uint64_t vertices, size_t objects,
               const Bounds& bounds) {
  const glm::vec3 size = bounds.high - bounds.low;
  fmt::print("{}: {} triangles, {} vertices, {}, {:.0f} x {:.0f} x {:.0f} m\n", file, triangles, vertices,
             counted(objects, "object"), size.x, size.y, size.z);
}

/// The files beside the scene that are asked for.
void saveBeside(const SceneArguments& arguments, const std::vector<ViewCell>& cells, const CameraPath& walk) {
  if (!arguments.cells.empty()) {
    saveCells(cells, arguments.cells);
    fmt::print("{}: {}\n", arguments.cells, counted(cells.size(), "view cell"));
  }
  if (!arguments.walk.empty()) {
    saveText(walkText(walk, arguments.walk), arguments.walk);
    fmt::print("{}: {}\n", arguments.walk, counted(walk.frames(), "frame"));
  }
}

/// The vertices are made twice, the triangles once.
SceneStream saveScan(uint64_t triangles, uint64_t seed, const SceneExtras& extras, const std::string& file) {
  ShareLine status("made");
  const auto tell = [&](uint64_t done, double all) {
    status.show(double(done) / all, [&] { return shortCount(done) + " vertices and triangles"; });
  };
  SceneStream stream = streamScan(triangles, seed, extras, [&](uint32_t vertices, uint32_t of) {
    tell(vertices, 4.0 * of);  // twice as many triangles as vertices
  });
  uint64_t done = stream.vertices;
  // Passes on what a part of the stream makes, and tells.
  const auto tellOf = [&](auto& part) {
    part = [&, make = std::move(part)](const auto& take) {
      make([&](const auto& some) {
        take(some);
        tell(done += some.size(), 2.0 * stream.vertices + stream.triangleCount());
      });
    };
  };
  tellOf(stream.positions);
  tellOf(stream.triangles);
  saveGlb(stream, file);
  status.end();
  return stream;
}

void run(const SceneArguments& arguments) {
  const std::array<std::filesystem::path, 3> files = {arguments.output, arguments.cells, arguments.walk};
  requireSeparate(files, {});
  for (const std::filesystem::path& file : files) requireNew(file, arguments.overwrite);
  const TextOutputs outputs({files.data(), 1});
  const auto& [name, output, cells_file, walk_file, frames, triangles, seed, kinds, extras, overwrite] =
      arguments;
  const std::vector<ViewCell> cells =
      kinds > 0 ? generateRepeatedCells(name, triangles, seed, kinds) : generateCells(name, triangles, seed);
  const CameraPath walk =
      walk_file.empty() ? CameraPath{} : generateWalk(name, triangles, seed, frames, kinds);
  if (name == "scan" && lowerExtension(arguments.output) == ".glb") {
    const SceneStream scan = saveScan(triangles, seed, extras, arguments.output);
    printSize(arguments.output, scan.triangleCount(), scan.vertices, scan.objects.size(), scan.bounds);
    return saveBeside(arguments, cells, walk);
  }
  const Scene scene = kinds > 0 ? generateRepeated(name, triangles, seed, kinds, extras.closed)
                                : generateScene(name, triangles, seed, extras);
  if (isStandardOutput(arguments.output)) {
    writeObj(scene, "standard output", [&](std::string_view piece) { outputs.write(piece); });
  } else {
    saveScene(scene, arguments.output);
  }
  printSize(arguments.output, scene.triangleCount(), scene.vertexCount(), scene.objects.size(),
            sceneBounds(scene));
  if (!scene.surfaces.empty()) {
    const SurfaceCounts counts = countSurfaces(scene);
    fmt::print("{}: {} triangles have holes, {} are glass\n", arguments.output, counts.masked, counts.glass);
  }
  if (scene.hasInstances()) {
    fmt::print("{}: {} triangles are stored, in {} of {} different ones\n", arguments.output,
               scene.triangles.size(), counted(scene.instances.size(), "instance"), scene.meshes.size());
  }
  saveBeside(arguments, cells, walk);
}

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const GeneratedSceneInfo& info : generatedScenes()) names.push_back(info.name);
  return names;
}

std::string footer() {
  std::string text = "Scenes:\n";
  for (const GeneratedSceneInfo& info : generatedScenes()) {
    text += helpEntry(info.name, info.about);
  }
  return text +
         "Units are metres, y is up. The same name, count and seed give the same file.\n\n"
         "Examples:\n"
         "  sightline scene city -o city.glb --cells city.json --walk walk.json\n"
         "  sightline scene plant -o plant.obj --triangles 200000 --seed 7\n";
}

}  // namespace

void addSceneCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("scene", "Generate a scene, and view cells that fit it");
  const auto arguments = std::make_shared<SceneArguments>();
  command->add_option("NAME", arguments->name, "city, canyon, plant, bistro or scan")
      ->required()
      ->check(oneOf(sceneNames()));
  command
      ->add_option("-o,--output", arguments->output,
                   "File to write: .obj or .glb; - writes OBJ to standard output")
      ->required();
  command
      ->add_option("--triangles", arguments->triangles,
                   "How many, at most: 1000 to 20000000, of the scan to 200000000, with --kinds to "
                   "1000000000. Extent and "
                   "detail grow with it")
      ->transform(wholeNumber())
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Another seed, another scene of the kind")
      ->transform(wholeNumber())
      ->capture_default_str();
  CLI::Option* const alpha = command->add_flag(
      "--alpha", arguments->extras.alpha,
      "City and bistro: leaves with holes, and panes and bottles of glass, as a .glb holds them");
  command
      ->add_flag("--closed", arguments->extras.closed,
                 "City: houses, pavements and the road are solid, each edge that of two triangles")
      ->excludes(alpha);
  command->add_flag("--holes", arguments->extras.holes, "Scan: open in some places, as scans are");
  command
      ->add_option("--kinds", arguments->kinds,
                   "City and plant: of so many different blocks or bays, which repeat. They are stored once "
                   "(in .glb); all count as triangles")
      ->transform(wholeNumber())
      ->excludes(alpha);
  command
      ->add_option("--cells", arguments->cells,
                   "Also write ten view cells in the scene's free space to this .json file")
      ->check(notStandardOutput("the cells of a scene"));
  CLI::Option* const walk =
      command
          ->add_option(
              "--walk", arguments->walk,
              "Also write a camera's walk through the scene's free space to this .json file: street level, a "
              "fast turn, cuts, a rise over all")
          ->check(notStandardOutput("the walk of a scene"));
  command
      ->add_option("--frames", arguments->frames,
                   fmt::format("Of the walk, {} to {}", kMinWalkFrames, kMostPathFrames))
      ->transform(wholeNumber(kMinWalkFrames, kMostPathFrames))
      ->needs(walk)
      ->capture_default_str();
  command->add_flag("--overwrite", arguments->overwrite, "Replace files that are there already");
  command->footer(footer());
  command->callback([arguments] { run(*arguments); });
}

}  // namespace sightline

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/free_cells.h"
#include "core/cli/free_side_option.h"
#include "core/cli/load_options.h"
#include "core/cli/number_checks.h"
#include "core/cli/overwrite.h"
#include "core/cli/points.h"
#include "core/cli/text_outputs.h"
#include "core/cli/watched_placing.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/formats/walk_file.h"
#include "core/gvs/bake_cell.h"
#include "core/io/file_io.h"
#include "core/place/clear_box.h"
#include "core/place/place_cells.h"
#include "core/scene/scene_tree.h"

namespace sightline {
namespace {

struct CellsArguments {
  std::filesystem::path scene, output;
  SceneLoadOptions load;
  bool overwrite = false;
  std::string grid;
  std::string origin;
  std::vector<std::string> region;
  std::vector<uint64_t> count;
  GridOptions grid_options;
  CLI::Option* free_side = nullptr;
  std::vector<std::string> path;
  std::filesystem::path walk;
  PathOptions path_options;
  std::optional<double> margin;
  FreeCellsArguments free;
};

/// So many cells are named one by one that were left out.
constexpr size_t kNamedCells = 10;

glm::dvec3 parseSize(const std::string& text) {
  const std::vector<double> numbers = parseNumbers(text, "--grid");
  if (numbers.size() == 1) return glm::dvec3(numbers[0]);
  return parsePoint(text, "--grid");
}

/// offset: of the scene; arguments have the file's coordinates.
GridOptions gridOptions(const CellsArguments& arguments, const glm::dvec3& offset) {
  GridOptions options = arguments.grid_options;
  options.size = parseSize(arguments.grid);
  options.margin = arguments.margin;
  if (!arguments.origin.empty()) options.origin = parsePoint(arguments.origin, "--origin") - offset;
  if (!arguments.region.empty()) {
    options.region = {parsePoint(arguments.region[0], "--region") - offset,
                      parsePoint(arguments.region[1], "--region") - offset};
  }
  if (!arguments.count.empty()) {
    options.count = {arguments.count[0], arguments.count[1], arguments.count[2]};
  }
  return options;
}

/// The grid's cells, with progress. Throws ExitCode if it was stopped.
std::vector<ViewCell> runGrid(const Scene& scene, const GridOptions& options, GridCounts& counts) {
  const Bvh bvh = buildSceneTree(scene);
  WatchedPlacing watched;
  GridHooks hooks;
  hooks.stop = watched.flag();
  hooks.progress = [&](uint64_t done, uint64_t boxes) {
    watched.show([&] {
      return fmt::format("grid: {} of {} boxes, {} %", done, boxes,
                         100 * done / std::max<uint64_t>(boxes, 1));
    });
  };
  return watched.run([&] { return gridCells(scene, bvh, options, &counts, hooks); });
}

std::vector<ViewCell> placeGrid(const Scene& scene, const CellsArguments& arguments) {
  GridCounts counts;
  GridOptions options = gridOptions(arguments, scene.offset);
  std::unique_ptr<FreeSpace> free;
  if (!arguments.free.reach.empty()) {
    free = findReached(scene, arguments.free, std::min({options.size.x, options.size.y, options.size.z}) / 8);
    options.space = &*free->space;
  }
  std::vector<ViewCell> cells = runGrid(scene, options, counts);
  const std::string line =
      fmt::format("{} boxes: {} kept, {} met by triangles, {} with nothing below, {} too high, {}",
                  counts.boxes, counts.kept, counts.blocked, counts.nothing_below, counts.too_high,
                  free ? fmt::format("{} not reached", counts.not_reached)
                       : fmt::format("{} inside of solids", counts.in_solid));
  if (cells.empty()) {
    throw Error("no free box in the grid (" + line + "); try a smaller size, another --origin" +
                (counts.in_solid > 0 ? ", or --free-side" : ""));
  }
  fmt::print("{}\n", line);
  if (counts.inset > 0) {
    fmt::print("{} of them are smaller, to keep clear of triangles (--margin)\n", counts.inset);
  }
  if (counts.in_solid > counts.kept) {
    fmt::print("note: if those are not solid, the scene's faces are turned: try --free-side back or any\n");
  }
  return cells;
}

/// Says, a line a cell, what meets those that are left out.
void sayBlocked(const std::vector<ClearCells::Blocked>& blocked) {
  for (size_t i = 0; i < std::min(blocked.size(), kNamedCells); ++i) {
    fmt::print("warning: {} is left out: {} reach into it too far to keep clear of them\n",
               blocked[i].cell.name, counted(blocked[i].triangles, "triangle"));
  }
  if (blocked.size() > kNamedCells) {
    fmt::print("warning: {} more cells are left out for the same reason\n", blocked.size() - kNamedCells);
  }
}

std::vector<ViewCell> placePath(const Scene& scene, const CellsArguments& arguments) {
  const PathOptions& options = arguments.path_options;
  std::vector<glm::dvec3> points = readPoints(arguments.path, "--path");
  for (glm::dvec3& point : points) point -= scene.offset;
  std::vector<ViewCell> cells = pathCells(points, options);
  const double smallest = std::min({options.width, options.height, options.length});
  const double margin = arguments.margin.value_or(defaultMargin(sceneBounds(scene), smallest));
  checkMargin(margin, smallest, "cells along a path");
  if (margin == 0) return cells;
  const Bvh bvh = buildSceneTree(scene);
  ClearCells clear = keepClear(scene, bvh, cells, margin);
  if (clear.cells.empty()) {
    throw Error(
        fmt::format("no box of the path is free: {} reach into {}; move the path, make it narrower or "
                    "lower, or take --margin 0",
                    counted(clear.blocked[0].triangles, "triangle"), clear.blocked[0].cell.name));
  }
  sayBlocked(clear.blocked);
  if (clear.inset > 0) {
    fmt::print("{} of {} boxes are smaller, to keep clear of triangles (--margin)\n", clear.inset,
               cells.size());
  }
  return std::move(clear.cells);
}

/// "3", "3 to 17", "3 to 17 and 40 more".
std::string runsText(const std::vector<uint32_t>& frames) {
  size_t run = 1;
  while (run < frames.size() && frames[run] == frames[run - 1] + 1) ++run;
  const std::string first =
      run == 1 ? fmt::format("{}", frames[0]) : fmt::format("{} to {}", frames[0], frames[run - 1]);
  return run == frames.size() ? first : fmt::format("{} and {} more", first, frames.size() - run);
}

std::vector<ViewCell> placeWalk(const Scene& scene, const CellsArguments& arguments) {
  const PathOptions& options = arguments.path_options;
  const CameraPath path = moved(loadWalk(arguments.walk), -scene.offset);
  const double smallest = std::min({options.width, options.height, options.length});
  const double margin = arguments.margin.value_or(defaultMargin(sceneBounds(scene), smallest));
  WalkCells walk = walkCells(scene, buildSceneTree(scene), path, options, margin);
  if (walk.cells.empty()) {
    throw Error(fmt::format(
        "no frame of the walk is {:g} away from all triangles; move it, or take --margin 0", margin));
  }
  if (!walk.frames_left_out.empty()) {
    fmt::print(
        "warning: no cell holds {} {}, in which the eye is nearer to a triangle than {:g} (--margin)\n",
        walk.frames_left_out.size() == 1 ? "frame" : "frames", runsText(walk.frames_left_out), margin);
  }
  if (walk.inset > 0) {
    fmt::print("{} of {} boxes are smaller, to keep clear of triangles (--margin)\n", walk.inset,
               walk.cells.size());
  }
  return std::move(walk.cells);
}

std::vector<ViewCell> placeCells(const Scene& scene, const CellsArguments& arguments) {
  if (!arguments.grid.empty()) return placeGrid(scene, arguments);
  if (arguments.free.floor) {
    return placeOnFloor(scene, arguments.free, arguments.margin, arguments.grid_options.free_side);
  }
  return arguments.walk.empty() ? placePath(scene, arguments) : placeWalk(scene, arguments);
}

void run(const CellsArguments& arguments) {
  const int ways = int(!arguments.grid.empty()) + int(!arguments.path.empty()) +
                   int(!arguments.walk.empty()) + int(arguments.free.floor.has_value());
  if (ways != 1) {
    throw Error("cells: takes one of --grid, --floor, --path and --walk (see: sightline cells --help)",
                kExitUsage);
  }
  if (arguments.grid.empty() && !arguments.free.floor &&
      (!arguments.free.reach.empty() || arguments.free_side->count() > 0)) {
    throw Error("cells: --reach and --free-side are of --grid and --floor", kExitUsage);
  }
  std::vector<std::filesystem::path> inputs(arguments.path.begin(), arguments.path.end());
  inputs.push_back(arguments.scene);
  inputs.push_back(arguments.walk);
  requireSeparate(std::array{arguments.output, arguments.free.picture}, inputs);
  requireNew(arguments.output, arguments.overwrite);
  const std::filesystem::path& picture = arguments.free.picture;
  if (!picture.empty()) {
    if (lowerExtension(picture) != ".png") {
      throw Error(fmt::format("{}: must end with .png", picture.string()), kExitUsage);
    }
    requireNew(picture, arguments.overwrite);
  }
  const TextOutputs outputs(std::array{arguments.output, picture});
  const Scene scene = loadScene(arguments.scene, arguments.load);
  const std::vector<ViewCell> cells = placeCells(scene, arguments);
  outputs.save(cellsText(moved(cells, scene.offset), arguments.output), arguments.output);
  fmt::print("{}: {} view cells\n", arguments.output.string(), cells.size());
}

constexpr const char* kCellsFooter =
    "Lengths are in the scene's units, y is up.\n\n"
    "A box of the grid is kept if no triangle reaches into it, something is straight\n"
    "below its centre, and it is not inside of something solid: at least half of the\n"
    "triangles that it sees are seen from their front (counter-clockwise), or what\n"
    "--free-side says.\n\n"
    "--reach finds free space by voxels, whatever faces there are: what joins with a\n"
    "place through voxels that no triangle meets. Boxes of the grid are kept where\n"
    "that is.\n\n"
    "Boxes of --floor stand where one walks: on voxels with --head free above, from\n"
    "one to the next by --step at most, in parts of the floor that are as large as a\n"
    "box, or on which one comes to stand from the places of --reach. Each covers as\n"
    "much as it can of what others leave, and holds the eye wherever one stands\n"
    "under it.\n\n"
    "A box that touches a wall sees, from its surface, what is behind. So sides with\n"
    "triangles near them come in, until they are --margin away; the others stay, and\n"
    "boxes meet each other there. A box of the path is left out if a side would come\n"
    "in by more than a quarter of its extent.\n\n"
    "The path runs through the boxes' middle. A file of points has x,y,z on each\n"
    "line; # starts a comment.\n\n"
    "Examples:\n"
    "  sightline cells level.obj -o cells.json --grid 8,3,8 --max-height 3\n"
    "  sightline cells level.obj -o cells.json --grid 2 --region -10,0,-10 10,4,10\n"
    "  sightline cells level.obj -o cells.json --grid 2 --origin -10,0,-10 \\\n"
    "      --count 10 1 10\n"
    "  sightline cells level.obj -o cells.json --grid 4,2,4 --reach 0,1.5,0\n"
    "  sightline cells level.obj -o cells.json --floor 4 --least 0.75\n"
    "  sightline cells city.glb -o cells.json --width 2.5 --height 2 --length 150 \\\n"
    "      --path 0,1.5,-200 0,1.5,200 120,1.5,200\n"
    "  sightline cells city.glb -o cells.json --path points.txt\n"
    "  sightline cells city.glb -o cells.json --walk walk.json --length 25\n";

void declareGrid(CLI::App& command, CellsArguments& a) {
  CLI::Option* grid = command.add_option("--grid", a.grid, "Boxes of this size over the scene: S, or X,Y,Z");
  command
      .add_option(
          "--origin", a.origin,
          "X,Y,Z of the grid's low corner, where its first box begins (default: that of the region or "
          "of the scene)")
      ->needs(grid);
  command
      .add_option("--region", a.region,
                  "Low and high corner, as X,Y,Z X,Y,Z, of the part of space that boxes cover (default: the "
                  "scene's bounds)")
      ->expected(2)
      ->type_name("MIN MAX")
      ->needs(grid);
  command.add_option("--count", a.count, "At most so many boxes along x, y and z, from the origin on")
      ->expected(3)
      ->transform(wholeNumber())
      ->type_name("NX NY NZ")
      ->needs(grid);
  command
      .add_option("--max-height", a.grid_options.max_height,
                  "Only boxes with something at most so far below them (default: any)")
      ->needs(grid);
  a.free_side =
      declareFreeSide(command, a.grid_options.free_side,
                      "front: keep boxes that see front faces; back: that see back faces; any: both");
}

void declarePath(CLI::App& command, CellsArguments& a) {
  CLI::Option* path =
      command.add_option("--path", a.path, "Boxes along these points: x,y,z x,y,z ..., or a file");
  CLI::Option* walk = command.add_option(
      "--walk", a.walk, "Boxes along a camera's walk (made by path or scene) that hold every frame's eye");
  const auto declareSize = [&](const char* name, double& value, const char* what) {
    command.add_option(name, value, what)->capture_default_str()->check([path, walk](const std::string&) {
      if (path->count() + walk->count() > 0) return std::string();
      return std::string("is of boxes along a --path or --walk, and neither is given");
    });
  };
  declareSize("--width", a.path_options.width, "Of a box on the path or walk, sideways");
  declareSize("--height", a.path_options.height, "Of a box on the path or walk, up");
  declareSize("--length", a.path_options.length, "Of a box along the path or walk, at most");
}

}  // namespace

void addCellsCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("cells", "Place view cells: a grid in free space, on the floor, or along a path");
  const auto a = std::make_shared<CellsArguments>();
  command->add_option("SCENE", a->scene, "Scene file: .obj, .gltf, .glb or .ply")->required();
  command->add_option("-o,--output", a->output, "Cells file to write (.json), or - for standard output")
      ->required();
  command->add_flag("--overwrite", a->overwrite, "Replace the cells file if it is there");
  command->add_option("--margin", a->margin,
                      "How far boxes keep from triangles; 0: they may touch, and those of the path cut, some "
                      "(default: a hundredth of their smallest extent)");
  declareLoading(*command, a->load);
  declareGrid(*command, *a);
  declareFreeCells(*command, a->free);
  declarePath(*command, *a);
  command->footer(kCellsFooter);
  command->callback([a] { run(*a); });
}

}  // namespace sightline

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "core/cli/commands.h"
#include "core/cli/name_checks.h"
#include "core/error.h"
#include "core/scene/contained.h"
#include "core/scene/file_io.h"
#include "core/scene/place_cells.h"

namespace sightline {
namespace {

struct CellsArguments {
  std::string scene;
  std::string output;
  std::string grid;
  std::string origin;
  GridOptions grid_options;
  std::string free_side = "front";
  std::vector<std::string> path;
  PathOptions path_options;
};

/// Numbers with commas between them. `what` and `where` start the error's line.
std::vector<double> parseNumbers(const std::string& text, const std::string& where) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value)) break;
    numbers.push_back(value);
    if (next == end) return numbers;
    if (*next != ',') break;
    at = next + 1;
  }
  throw Error(where + ": '" + text + "' is not numbers with commas between them, as in 1.5,0,-20",
              kExitUsage);
}

glm::dvec3 parsePoint(const std::string& text, const std::string& where) {
  const std::vector<double> numbers = parseNumbers(text, where);
  if (numbers.size() != 3) {
    throw Error(where + ": '" + text + "' has " + std::to_string(numbers.size()) + " numbers, expected x,y,z",
                kExitUsage);
  }
  return {numbers[0], numbers[1], numbers[2]};
}

glm::dvec3 parseSize(const std::string& text) {
  const std::vector<double> numbers = parseNumbers(text, "--grid");
  if (numbers.size() == 1) return glm::dvec3(numbers[0]);
  return parsePoint(text, "--grid");
}

/// Points from the arguments; one that names a file stands for the points in it, one a line.
std::vector<glm::dvec3> readPath(const std::vector<std::string>& arguments) {
  std::vector<glm::dvec3> points;
  for (const std::string& argument : arguments) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(argument, ignored)) {
      points.push_back(parsePoint(argument, "--path"));
      continue;
    }
    std::ifstream file(argument);
    std::string line;
    for (uint64_t number = 1; std::getline(file, line); ++number) {
      std::istringstream words(line.substr(0, line.find('#')));
      for (std::string word; words >> word;) {
        points.push_back(parsePoint(word, argument + ":" + std::to_string(number)));
      }
    }
    if (!file.eof()) throw Error(argument + ": cannot be read");
  }
  return points;
}

std::vector<ViewCell> placeGrid(const Scene& scene, const GridOptions& options) {
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  GridCounts counts;
  std::vector<ViewCell> cells = gridCells(scene, bvh, options, &counts);
  const std::string line = fmt::format(
      "{} boxes: {} kept, {} met by triangles, {} with nothing below, {} too high, {} inside of solids",
      counts.boxes, counts.kept, counts.blocked, counts.nothing_below, counts.too_high, counts.in_solid);
  if (cells.empty()) {
    throw Error("no free box in the grid (" + line + "); try a smaller size, another --origin" +
                (counts.in_solid > 0 ? ", or --free-side" : ""));
  }
  fmt::print("{}\n", line);
  if (counts.in_solid > counts.kept) {
    fmt::print("note: if those are not solid, the scene's faces are turned: try --free-side back or any\n");
  }
  return cells;
}

std::vector<ViewCell> placePath(const Scene& scene, const CellsArguments& arguments) {
  std::vector<ViewCell> cells = pathCells(readPath(arguments.path), arguments.path_options);
  for (const ViewCell& cell : cells) {
    const size_t met = containedTriangles(scene, cell).size();
    if (met > 0) fmt::print("note: {} meets {} triangles\n", cell.name, met);
  }
  return cells;
}

void run(CellsArguments arguments) {
  if (arguments.grid.empty() == arguments.path.empty()) {
    throw Error("cells: takes either --grid or --path (see: sightline cells --help)", kExitUsage);
  }
  if (!arguments.grid.empty()) arguments.grid_options.size = parseSize(arguments.grid);
  if (!arguments.origin.empty()) arguments.grid_options.origin = parsePoint(arguments.origin, "--origin");
  arguments.grid_options.free_side = arguments.free_side == "front"  ? FreeSide::kFront
                                     : arguments.free_side == "back" ? FreeSide::kBack
                                                                     : FreeSide::kAny;
  std::vector<std::filesystem::path> inputs(arguments.path.begin(), arguments.path.end());
  inputs.push_back(arguments.scene);
  requireSeparate(std::array<std::filesystem::path, 1>{arguments.output}, inputs);
  const Scene scene = loadScene(arguments.scene);
  const std::vector<ViewCell> cells =
      arguments.grid.empty() ? placePath(scene, arguments) : placeGrid(scene, arguments.grid_options);
  saveCells(cells, arguments.output);
  fmt::print("{}: {} view cells\n", arguments.output, cells.size());
}

constexpr const char* kFooter =
    "Lengths are in the scene's units, y is up.\n\n"
    "A box of the grid is kept if no triangle meets it (one may touch it), something is straight\n"
    "below its centre, and it is not inside of something solid: at least half of the triangles that\n"
    "it sees are seen from their front (counter-clockwise), or what --free-side says.\n\n"
    "The path runs through the boxes' middle. A file of points has x,y,z on each line; # starts a\n"
    "comment.\n\n"
    "Examples:\n"
    "  sightline cells level.obj -o cells.json --grid 8,3,8 --max-height 3\n"
    "  sightline cells city.glb -o cells.json --path 0,1.5,-200 0,1.5,200 120,1.5,200 \\\n"
    "      --width 2.5 --height 2 --length 150\n"
    "  sightline cells city.glb -o cells.json --path points.txt\n";

}  // namespace

void addCellsCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("cells", "Place view cells: a grid in free space, or along a path");
  const auto a = std::make_shared<CellsArguments>();
  command->add_option("SCENE", a->scene, "Scene file: .obj, .gltf, .glb or .ply")->required();
  command->add_option("-o,--output", a->output, "Cells file to write (.json)")->required();
  command->add_option("--grid", a->grid, "Boxes of this size over the scene: S, or X,Y,Z");
  command->add_option("--origin", a->origin,
                      "X,Y,Z of a corner of the grid (default: the scene's low corner)");
  command->add_option("--max-height", a->grid_options.max_height,
                      "Only boxes with something at most so far below them (default: any)");
  command
      ->add_option("--free-side", a->free_side,
                   "front: keep boxes that see front faces; back: that see back faces; any: both")
      ->check(oneOf({"front", "back", "any"}))
      ->capture_default_str();
  command->add_option("--path", a->path, "Boxes along these points: x,y,z x,y,z ..., or a file");
  command->add_option("--width", a->path_options.width, "Of a box on the path, sideways")
      ->capture_default_str();
  command->add_option("--height", a->path_options.height, "Of a box on the path, up")->capture_default_str();
  command->add_option("--length", a->path_options.length, "Of a box along the path, at most")
      ->capture_default_str();
  command->footer(kFooter);
  command->callback([a] { run(*a); });
}

}  // namespace sightline

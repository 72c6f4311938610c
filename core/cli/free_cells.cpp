#include "core/cli/free_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/points.h"
#include "core/cli/watched_placing.h"
#include "core/picture/floor_picture.h"
#include "core/scene/scene_tree.h"
#include "core/voxel/reach.h"
#include "core/voxel/voxelize.h"

namespace sightline {
namespace {

constexpr uint32_t kLongestPicture = 1600;  // pixels

Lattice chooseLattice(const Scene& scene, const FreeCellsArguments& arguments, double largest_voxel) {
  int exponent = 0;
  std::frexp(largest_voxel, &exponent);
  const Lattice lattice = arguments.voxel ? latticeOf(*arguments.voxel) : Lattice{exponent - 1};
  requireFits(lattice, sceneBounds(scene));
  return lattice;
}

std::vector<glm::dvec3> seedsOf(const Scene& scene, const FreeCellsArguments& arguments) {
  std::vector<glm::dvec3> seeds;
  if (!arguments.reach.empty()) seeds = readPoints(arguments.reach, "--reach");
  for (glm::dvec3& seed : seeds) seed -= scene.offset;
  return seeds;
}

std::unique_ptr<FreeSpace> voxelizeScene(const Scene& scene, const Lattice& lattice,
                                         WatchedPlacing& watched) {
  auto result = std::make_unique<FreeSpace>();
  VoxelizeOptions options{.lattice = lattice, .with_triangles = false};
  const auto show = watched.progress("voxels");
  options.progress = [&](double done, uint64_t) { show(done); };
  options.stop = watched.flag();
  result->grid = voxelize(scene, options);
  return result;
}

std::unique_ptr<FreeSpace> reachFrom(const Scene& scene, const Lattice& lattice,
                                     const std::vector<glm::dvec3>& seeds, WatchedPlacing& watched) {
  std::unique_ptr<FreeSpace> result = voxelizeScene(scene, lattice, watched);
  ReachOptions options{.seeds = seeds};
  options.progress = watched.progress("free space");
  options.stop = watched.flag();
  result->space = reach(result->grid, options);
  return result;
}

std::string voxelsText(const Lattice& lattice) {
  return fmt::format("voxels of {:g}", lattice.voxelSize());
}

struct PlacedOnFloor {
  FloorCells cells;
  size_t parts = 0, all_parts = 0;
};

PlacedOnFloor runFloor(const Scene& scene, const FreeSpace& free, const std::vector<glm::dvec3>& seeds,
                       const FloorCellOptions& options) {
  const WalkedFloor walked = walkedFloor(*free.space, seeds, options);
  return {floorCells(scene, buildSceneTree(scene), free.grid.lattice, walked.floor, options),
          walked.floor.part_sizes.size(), walked.all_parts};
}

}  // namespace

std::unique_ptr<FreeSpace> findReached(const Scene& scene, const FreeCellsArguments& arguments,
                                       double largest_voxel) {
  const Lattice lattice = chooseLattice(scene, arguments, largest_voxel);
  const std::vector<glm::dvec3> seeds = seedsOf(scene, arguments);
  WatchedPlacing watched;
  std::unique_ptr<FreeSpace> free = watched.run([&] { return reachFrom(scene, lattice, seeds, watched); });
  fmt::print("{}: {}\n", voxelsText(lattice), reachedText(free->space->counts()));
  return free;
}

std::vector<ViewCell> placeOnFloor(const Scene& scene, const FreeCellsArguments& arguments,
                                   const std::optional<double>& margin, FreeSide free_side) {
  FloorCellOptions options = arguments.floor_options;
  options.largest = *arguments.floor;
  options.margin = margin;
  const std::vector<glm::dvec3> seeds = seedsOf(scene, arguments);
  // Free space is known by reach; without, by the faces that one sees.
  options.free_side = seeds.empty() ? free_side : FreeSide::kAny;
  const Lattice lattice = chooseLattice(scene, arguments, std::min(options.head / 12, options.least / 2));
  floorOptions(lattice, options);  // refuses before the work
  WatchedPlacing watched;
  options.progress = watched.progress("cells");
  options.stop = watched.flag();
  const PlacedOnFloor placed = watched.run([&] {
    const std::unique_ptr<FreeSpace> free =
        seeds.empty() ? voxelizeScene(scene, lattice, watched) : reachFrom(scene, lattice, seeds, watched);
    if (!free->space) free->space.emplace(free->grid);
    return runFloor(scene, *free, seeds, options);
  });
  const FloorCells& cells = placed.cells;
  const double tile = lattice.voxelSize() * lattice.voxelSize();
  fmt::print("floor: {:.4g} square units in {} of {}, in {}\n", double(cells.floor.tiles.size()) * tile,
             placed.parts, counted(placed.all_parts, "part"), voxelsText(lattice));
  if (cells.cells.empty()) {
    throw Error("no box fits on the floor" +
                std::string(cells.in_solid > 0 ? " outside of solids: try --free-side or --reach"
                                               : ": try a smaller --least"));
  }
  fmt::print("{} {:.1f} % of it\n",
             cells.cells.size() == 1 ? "1 box covers" : fmt::format("{} boxes cover", cells.cells.size()),
             100 * double(cells.covered) / double(cells.floor.tiles.size()));
  if (cells.in_solid > 0) fmt::print("{} more are inside of solids\n", cells.in_solid);
  if (cells.inset > 0) {
    fmt::print("{} of them are smaller, to keep clear of triangles (--margin)\n", cells.inset);
  }
  if (!arguments.picture.empty()) {
    savePng(floorPicture(lattice, cells.floor, cells.is_covered, cells.cells, kLongestPicture),
            arguments.picture);
  }
  return cells.cells;
}

void declareFreeCells(CLI::App& command, FreeCellsArguments& a) {
  const auto length_check = [](bool may_be_zero) {
    return CLI::Validator(
        [may_be_zero](std::string& text) {
          double value = 0;
          if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) &&
              (value > 0 || (may_be_zero && value == 0))) {
            return std::string();
          }
          return fmt::format("{} is not {}", text, may_be_zero ? "0 or a number above" : "a number above 0");
        },
        "");
  };
  CLI::Option* reach = command.add_option(
      "--reach", a.reach,
      "Only boxes that are reached from these places, x,y,z x,y,z ... or a file, through voxels without "
      "triangles");
  CLI::Option* floor = command.add_option(
      "--floor", a.floor, "Boxes that stand on the floor where one walks, seen from above at most so large");
  floor->check(length_check(false));
  command
      .add_option("--voxel", a.voxel,
                  "Size of voxels, a power of two (default: an eighth of a box or less, on the floor half of "
                  "--least and a twelfth of --head)")
      ->check([reach, floor](const std::string&) {
        if (reach->count() + floor->count() > 0) return std::string();
        return std::string("is of --reach and --floor, and neither is given");
      });
  FloorCellOptions& o = a.floor_options;
  const auto length = [&](const char* name, double& value, const char* what, bool may_be_zero = false) {
    command.add_option(name, value, what)
        ->capture_default_str()
        ->check(length_check(may_be_zero))
        ->needs(floor);
  };
  command
      .add_option("--picture", a.picture,
                  "A picture of the floor from above to write (.png): what boxes cover green, what not red")
      ->needs(floor);
  length("--least", o.least, "Of boxes on the floor: their sides at least");
  length("--eye", o.eye, "Of one who walks: the eye's height above the floor");
  length("--head", o.head, "And the free height that is needed, up to which boxes reach");
  length("--step", o.step, "And how far the floor may rise at a step", true);
}

}  // namespace sightline

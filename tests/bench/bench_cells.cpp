// How much of the floor of a scene cells hold that a plain grid places, and those of the same size that stand
// on the floor: a row each, with the boxes that it takes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/formats/load_scene.h"
#include "core/place/floor_cells.h"
#include "core/place/place_cells.h"
#include "core/scene/scene_tree.h"
#include "core/voxel/voxelize.h"
#include "tests/bench/bench_main.h"

using namespace sightline;

namespace {

void row(const std::string& what, uint64_t boxes, uint64_t covered, uint64_t tiles) {
  fmt::print("| {:<32} | {:>6} | {:>5.1f} % |\n", what, boxes, 100 * double(covered) / double(tiles));
}

// The grid's boxes by their places from above: what it has over the scene, kept or not, in one layer.
uint64_t placesFromAbove(const Bounds& bounds, const glm::dvec3& size) {
  const glm::dvec3 extent = glm::dvec3(bounds.high) - glm::dvec3(bounds.low);
  return uint64_t(std::ceil(extent.x / size.x) * std::ceil(extent.z / size.z));
}

// Of its tiles.
int middleHeight(const Floor& floor) {
  std::vector<int> heights;
  for (const FloorTile& tile : floor.tiles) heights.push_back(tile.y);
  std::ranges::nth_element(heights, heights.begin() + int64_t(heights.size() / 2));
  return heights[heights.size() / 2];
}

void measure(const std::string& path, double largest, double least) {
  const Scene scene = loadScene(path);
  const Bvh bvh = buildSceneTree(scene);
  FloorCellOptions options;
  options.largest = largest;
  options.least = least;
  options.free_side = FreeSide::kFront;
  const Lattice lattice = latticeOf(0.125);
  const VoxelGrid grid = voxelize(scene, {.lattice = lattice, .with_triangles = false});
  const VoxelSpace space(grid);
  const WalkedFloor walked = walkedFloor(space, {}, options);
  const FloorCells on_floor = floorCells(scene, bvh, lattice, walked.floor, options);
  const uint64_t tiles = on_floor.floor.tiles.size();
  fmt::print("{}: {:.0f} square units of floor, voxels of {}\n", path,
             double(tiles) * lattice.voxelSize() * lattice.voxelSize(), lattice.voxelSize());
  for (const bool is_raised : {false, true}) {
    GridOptions grid_options;
    grid_options.size = {largest, 2, largest};
    if (is_raised) {  // on the floor instead of in it
      grid_options.origin = glm::dvec3(sceneBounds(scene).low);
      grid_options.origin->y = middleHeight(on_floor.floor) * lattice.voxelSize();
    }
    GridCounts counts;
    const std::vector<ViewCell> cells = gridCells(scene, bvh, grid_options, &counts);
    const auto covered =
        uint64_t(std::ranges::count(coveredTiles(lattice, on_floor.floor, options.eye, cells), uint8_t{1}));
    row(fmt::format("--grid {0},2,{0}{1}", largest, is_raised ? ", raised to the floor" : ""), counts.kept,
        covered, tiles);
    row("  its places, seen from above", placesFromAbove(sceneBounds(scene), grid_options.size), covered,
        tiles);
  }
  row(fmt::format("--floor {} --least {}", largest, least), on_floor.cells.size(), on_floor.covered, tiles);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Cells of a grid against cells on the floor", "bench_cells");
  std::string path;
  double largest = 4, least = 0.75;
  app.add_option("SCENE", path)->required();
  app.add_option("--floor", largest)->capture_default_str();
  app.add_option("--least", least)->capture_default_str();
  return benchMain(app, argc, argv, [&] { measure(path, largest, least); });
}

#include "core/picture/floor_picture.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

constexpr Rgb kNoFloor{245, 245, 242}, kCovered{150, 200, 150}, kUncovered{215, 70, 60}, kOutline{30, 80, 45};
constexpr int kFrame = 2;  // tiles around the floor

}  // namespace

Image floorPicture(const Lattice& lattice, const Floor& floor, std::span<const uint8_t> is_covered,
                   std::span<const ViewCell> cells, uint32_t longest) {
  glm::ivec2 low(floor.tiles.front().x, floor.tiles.front().z), high = low;
  for (const FloorTile& tile : floor.tiles) {
    low = glm::min(low, glm::ivec2(tile.x, tile.z));
    high = glm::max(high, glm::ivec2(tile.x, tile.z));
  }
  low -= kFrame;
  high += kFrame;
  const glm::ivec2 size = high - low + 1;
  const double scale = std::min(8.0, double(longest) / std::max(size.x, size.y));  // pixels a tile
  const auto pixelOf = [&](double place, int axis) { return int(std::floor((place - low[axis]) * scale)); };
  Image image(uint32_t(std::max(pixelOf(high.x + 1, 0), 1)), uint32_t(std::max(pixelOf(high.y + 1, 1), 1)),
              kNoFloor);
  for (size_t i = 0; i < floor.tiles.size(); ++i) {  // of those in the same place the highest comes last
    const FloorTile& tile = floor.tiles[i];
    for (int y = pixelOf(tile.z, 1); y < std::max(pixelOf(tile.z + 1, 1), pixelOf(tile.z, 1) + 1); ++y) {
      for (int x = pixelOf(tile.x, 0); x < std::max(pixelOf(tile.x + 1, 0), pixelOf(tile.x, 0) + 1); ++x) {
        image.at(uint32_t(x), uint32_t(y)) = is_covered[i] != 0 ? kCovered : kUncovered;
      }
    }
  }
  const auto mark = [&](int x, int y) {
    if (x >= 0 && y >= 0 && x < int(image.width) && y < int(image.height)) {
      image.at(uint32_t(x), uint32_t(y)) = kOutline;
    }
  };
  for (const ViewCell& cell : cells) {
    const glm::dvec3 from = (cell.center - cell.size * 0.5) / lattice.voxelSize(),
                     to = (cell.center + cell.size * 0.5) / lattice.voxelSize();
    const int left = pixelOf(from.x, 0), right = pixelOf(to.x, 0);
    const int top = pixelOf(from.z, 1), bottom = pixelOf(to.z, 1);
    for (int x = left; x <= right; ++x) {
      mark(x, top);
      mark(x, bottom);
    }
    for (int y = top; y <= bottom; ++y) {
      mark(left, y);
      mark(right, y);
    }
  }
  return image;
}

}  // namespace sightline

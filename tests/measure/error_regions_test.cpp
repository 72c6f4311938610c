// Regions of wrong pixels against a flood fill, prefix by prefix.
#include "core/measure/error_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sightline {

void PrintTo(const ImageError& e, std::ostream* out) {
  *out << e.wrong << " wrong, " << e.regions << " regions, largest " << e.largest_region;
}

namespace {

/// Flood fill over the 8 neighbours.
ImageError bruteForce(std::vector<int> wrong, int side) {
  ImageError error;
  error.wrong = uint32_t(std::count(wrong.begin(), wrong.end(), 1));
  for (int start = 0; start < side * side; ++start) {
    if (wrong[size_t(start)] == 0) continue;
    ++error.regions;
    uint32_t size = 0;
    std::vector<int> open{start};
    wrong[size_t(start)] = 0;
    while (!open.empty()) {
      const int pixel = open.back();
      open.pop_back();
      ++size;
      for (int y = pixel / side - 1; y <= pixel / side + 1; ++y) {
        for (int x = pixel % side - 1; x <= pixel % side + 1; ++x) {
          if (x < 0 || y < 0 || x >= side || y >= side || wrong[size_t(y * side + x)] == 0) continue;
          wrong[size_t(y * side + x)] = 0;
          open.push_back(y * side + x);
        }
      }
    }
    error.largest_region = std::max(error.largest_region, size);
  }
  return error;
}

std::vector<ImageError> countOf(ErrorRegions& regions, const std::vector<uint16_t>& image, size_t prefixes) {
  std::vector<uint32_t> pixels;
  std::vector<uint16_t> levels;
  for (uint32_t i = 0; i < image.size(); ++i) {
    if (image[i] == 0) continue;
    pixels.push_back(i);
    levels.push_back(image[i]);
  }
  std::vector<ImageError> errors(prefixes);
  regions.count(pixels, levels, errors);
  return errors;
}

TEST(ErrorRegions, CountsAsAFloodFillDoes) {
  std::mt19937 random(4711);
  for (const int side : {1, 2, 3, 17, 40}) {
    ErrorRegions regions{uint32_t(side)};
    for (int round = 0; round < 60; ++round) {
      const size_t prefixes = 1 + random() % 6;
      const size_t density = 1 + random() % 99;  // percent
      std::vector<uint16_t> image(size_t(side) * size_t(side));
      for (uint16_t& level : image) {
        level = random() % 100 < density ? uint16_t(1 + random() % prefixes) : uint16_t(0);
      }
      const std::vector<ImageError> errors = countOf(regions, image, prefixes);
      for (size_t k = 0; k < prefixes; ++k) {
        std::vector<int> wrong;
        for (const uint16_t level : image) wrong.push_back(level > k ? 1 : 0);
        ASSERT_EQ(errors[k], bruteForce(wrong, side))
            << "side " << side << ", round " << round << ", prefix " << k;
      }
    }
  }
}

/// Pixels that touch at a corner are one region; rows do not touch around the image's edge.
TEST(ErrorRegions, CornersTouchAndEdgesDoNot) {
  ErrorRegions regions(4);
  const std::vector<uint16_t> diagonal = {1, 0, 0, 0,  //
                                          0, 1, 0, 0,  //
                                          0, 0, 1, 0,  //
                                          0, 0, 0, 1};
  EXPECT_EQ(countOf(regions, diagonal, 1).front(), (ImageError{4, 1, 4}));
  const std::vector<uint16_t> edges = {0, 0, 0, 1,  //
                                       1, 0, 0, 0,  //
                                       0, 0, 0, 0,  //
                                       0, 1, 0, 0};
  EXPECT_EQ(countOf(regions, edges, 1).front(), (ImageError{3, 3, 1}));
  EXPECT_EQ(countOf(regions, std::vector<uint16_t>(16, 1), 1).front(), (ImageError{16, 1, 16}));
  EXPECT_EQ(countOf(regions, std::vector<uint16_t>(16, 0), 1).front(), (ImageError{0, 0, 0}));
}

}  // namespace
}  // namespace sightline

// Regions of wrong pixels against a flood fill, prefix by prefix.
#include "core/measure/error_regions.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/measure/flood_fill.h"

namespace sightline {
namespace {

using testing_support::floodFill;

/// Runs as long as they can be, and some in pieces.
std::vector<ImageError> countOf(ErrorRegions& regions, int side, const std::vector<uint16_t>& image,
                                size_t prefixes) {
  std::vector<PixelRun> runs;
  for (uint32_t i = 0; i < image.size(); ++i) {
    if (image[i] == 0) continue;
    const bool goes_on = i % uint32_t(side) != 0 && image[i - 1] == image[i] && i % 5 != 0;
    if (goes_on) {
      runs.back().last = i;
    } else {
      runs.push_back({i, i, image[i]});
    }
  }
  std::vector<ImageError> errors(prefixes);
  regions.count(runs, errors);
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
      const std::vector<ImageError> errors = countOf(regions, side, image, prefixes);
      for (size_t k = 0; k < prefixes; ++k) {
        std::vector<int> wrong;
        for (const uint16_t level : image) wrong.push_back(level > k ? 1 : 0);
        ASSERT_EQ(errors[k], floodFill(wrong, side))
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
  EXPECT_EQ(countOf(regions, 4, diagonal, 1).front(), (ImageError{4, 1, 4}));
  const std::vector<uint16_t> edges = {0, 0, 0, 1,  //
                                       1, 0, 0, 0,  //
                                       0, 0, 0, 0,  //
                                       0, 1, 0, 0};
  EXPECT_EQ(countOf(regions, 4, edges, 1).front(), (ImageError{3, 3, 1}));
  EXPECT_EQ(countOf(regions, 4, std::vector<uint16_t>(16, 1), 1).front(), (ImageError{16, 1, 16}));
  EXPECT_EQ(countOf(regions, 4, std::vector<uint16_t>(16, 0), 1).front(), (ImageError{0, 0, 0}));
  ErrorRegions wide(5, 2);
  EXPECT_EQ(countOf(wide, 5,
                    {1, 0, 0, 1, 1,  //
                     1, 0, 1, 0, 0},
                    1)
                .front(),
            (ImageError{5, 2, 3}));
}

}  // namespace
}  // namespace sightline

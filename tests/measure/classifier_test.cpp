// Right and wrong pixels of id images against a flood fill, for every prefix of every set.
#include "core/measure/classifier.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/measure/flood_fill.h"

namespace sightline {
namespace {

constexpr int kImageSide = 24;
constexpr uint32_t kTriangles = 12;

/// Patches of a few triangles, and some of nothing at all: `background` percent.
std::vector<uint32_t> randomImage(std::mt19937& random, uint32_t background) {
  std::vector<uint32_t> image(size_t(kImageSide) * kImageSide, kNoTriangle);
  for (int patch = 0; patch < 60; ++patch) {
    const uint32_t triangle = random() % 100 < background ? kNoTriangle : uint32_t(random() % kTriangles);
    const int left = int(random() % kImageSide), top = int(random() % kImageSide);
    const int right = std::min(kImageSide, left + 1 + int(random() % 9)),
              low = std::min(kImageSide, top + 1 + int(random() % 5));
    for (int y = top; y < low; ++y) {
      for (int x = left; x < right; ++x) image[size_t(y * kImageSide + x)] = triangle;
    }
  }
  return image;
}

RankedSet randomSet(std::mt19937& random, std::vector<uint32_t> prefixes) {
  RankedSet set{std::vector<uint32_t>(kTriangles, kNoRank), std::move(prefixes)};
  for (uint32_t& rank : set.rank) {
    if (random() % 4 != 0) rank = uint32_t(random() % 10);
  }
  return set;
}

ImageError expected(const std::vector<uint32_t>& image, const RankedSet& set, size_t prefix) {
  std::vector<int> wrong;
  for (const uint32_t triangle : image) {
    wrong.push_back(triangle != kNoTriangle && set.rank[triangle] >= set.prefixes[prefix] ? 1 : 0);
  }
  return testing_support::floodFill(wrong, kImageSide);
}

/// Prefixes of nothing are counted once for all sets: the numbers are those of each alone.
TEST(Classifier, CountsEveryPrefixAsAFloodFillDoes) {
  for (uint32_t seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    const std::vector<RankedSet> sets = {randomSet(random, {0, 0, 0, 2, 5, 5, 100}), randomSet(random, {0}),
                                         randomSet(random, {0, 0}), randomSet(random, {1, 4, 9}),
                                         randomSet(random, {100})};
    const std::vector<uint32_t> images[] = {randomImage(random, 0), randomImage(random, 30),
                                            randomImage(random, 100)};
    Classifier classifier(sets, 3, kImageSide);
    for (uint32_t view = 0; view < 3; ++view) classifier.classify(view, images[view]);
    for (size_t s = 0; s < sets.size(); ++s) {
      for (uint32_t view = 0; view < 3; ++view) {
        for (size_t k = 0; k < sets[s].prefixes.size(); ++k) {
          ASSERT_EQ(classifier.errors(s, view)[k], expected(images[view], sets[s], k))
              << "seed " << seed << ", set " << s << ", view " << view << ", prefix " << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace sightline

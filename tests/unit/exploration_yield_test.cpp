#include "core/gvs/exploration_yield.h"

#include <gtest/gtest.h>

namespace sightline {
namespace {

constexpr uint32_t kBatch = 1u << 20;

TEST(ExplorationYield, PromisesWhatTheLastBatchesFound) {
  ExplorationYield yield(kBatch);
  yield.bookBorder(1000, 20'000, 500);
  // A full batch: 1/40 a ray, of eight ninths of what it costs.
  EXPECT_NEAR(yield.border(1'000'000), 1.0 / 40 * 8 / 9, 1e-12);
  yield.bookReverse(kBatch, 100);  // counts half
  EXPECT_NEAR(yield.reverse(), 50.0 / kBatch * 8 / 9, 1e-12);
  yield.bookReverse(0, 0);  // every ray was excluded
  EXPECT_EQ(yield.reverse(), 0);
}

TEST(ExplorationYield, FewEntriesPromiseLess) {
  ExplorationYield yield(kBatch);
  yield.bookBorder(1000, 20'000, 500);
  EXPECT_LT(yield.border(10), yield.border(1000) / 50);
  EXPECT_LT(yield.border(1000), yield.border(100'000));
}

TEST(ExplorationYield, TriesBothKindsAtFirst) {
  const ExplorationYield yield(kBatch);
  EXPECT_GT(yield.border(1000), 0);
  EXPECT_GT(yield.reverse(), 0);
}

}  // namespace
}  // namespace sightline

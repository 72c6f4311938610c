#include "core/shared/set.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <map>
#include <random>

#include "core/base/error.h"
#include "core/device/cpu/host_set.h"
#include "core/device/hash_capacity.h"

namespace sightline {
namespace {

/// Ids around and past 2^24, where a float would lose them.
std::vector<std::pair<uint32_t, uint32_t>> insertions(uint32_t triangle_count) {
  std::mt19937 random(3);
  std::vector<std::pair<uint32_t, uint32_t>> list;
  for (uint32_t ray = 1; ray <= 200'000; ++ray) {
    const auto id = static_cast<uint32_t>(random());
    list.push_back({ray % 2 == 0 ? (1u << 24) + id % 5000 : id % triangle_count, ray});
  }
  std::shuffle(list.begin(), list.end(), random);
  return list;
}

constexpr uint32_t kTriangles = (1u << 24) + 5003;

class Set : public testing::TestWithParam<bool> {};

TEST_P(Set, KeepsTheLowestRayOfEveryTriangle) {
  HostSet set(kTriangles, GetParam());
  if (GetParam()) set.grow(16);
  const auto list = insertions(kTriangles);
  std::map<uint32_t, uint32_t> expected;
  for (const auto& [triangle, ray] : list) {
    const auto [place, is_new] = expected.try_emplace(triangle, ray);
    if (!is_new) place->second = std::min(place->second, ray);
  }
  tbb::parallel_for(size_t(0), list.size(),
                    [&](size_t i) { insertHit(set.ref(), list[i].first, list[i].second); });
  ASSERT_FALSE(set.takeOverflow());
  for (const auto& [triangle, ray] : expected) {
    ASSERT_TRUE(isInSet(set.ref(), triangle)) << triangle;
    ASSERT_EQ(set.ref().winner[findSlot(set.ref(), triangle)], ray) << triangle;
    ASSERT_TRUE(set.fresh()[triangle / 32] >> (triangle % 32) & 1) << triangle;
  }
  size_t fresh = 0;
  for (const uint32_t word : set.fresh()) fresh += static_cast<size_t>(std::popcount(word));
  EXPECT_EQ(fresh, expected.size());
  EXPECT_FALSE(isInSet(set.ref(), expected.rbegin()->first + 1));
}

TEST_P(Set, OldTrianglesStayOld) {
  HostSet set(100, GetParam());
  insertHit(set.ref(), 42, 9);
  set.ref().winner[findSlot(set.ref(), 42)] = kSlotOld;
  set.fresh()[1] = 0;
  insertHit(set.ref(), 42, 1);
  EXPECT_EQ(set.fresh()[1], 0u);
  EXPECT_EQ(set.ref().winner[findSlot(set.ref(), 42)], kSlotOld);
  insertHit(set.ref(), kNoTriangle, 1);  // a miss
  EXPECT_EQ(set.fresh()[0] | set.fresh()[2] | set.fresh()[3], 0u);
}

/// An array overflows where a thread loses every race for a slot; the launch is repeated and must find the
/// set as it was.
TEST_P(Set, GrowingAfterAnOverflowLosesNothing) {
  HostSet set(100, GetParam());
  insertHit(set.ref(), 42, 9);
  ++*set.ref().overflow;
  ASSERT_TRUE(set.takeOverflow());
  const uint64_t bytes = set.bytes();
  set.grow(4);
  ASSERT_GE(set.bytes(), bytes);
  EXPECT_EQ(set.isHash(), GetParam());
  insertHit(set.ref(), 42, 7);
  insertHit(set.ref(), 99, 8);
  EXPECT_FALSE(set.takeOverflow());
  ASSERT_TRUE(isInSet(set.ref(), 42));
  EXPECT_EQ(set.ref().winner[findSlot(set.ref(), 42)], 7u);
  EXPECT_TRUE(isInSet(set.ref(), 99));
  EXPECT_FALSE(isInSet(set.ref(), 98));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Set, testing::Bool(),
                         [](const auto& kind) { return std::string(kind.param ? "Hash" : "Array"); });

/// The reference implementation's insertion looped for ever in a full table.
TEST(HashSet, FullTableRaisesTheFlagAndGrowingKeepsEverything) {
  HostSet set(kTriangles, true);
  const uint32_t capacity = set.capacity();
  for (uint32_t id = 0; id < capacity + 1000; ++id) insertHit(set.ref(), id, id + 1);
  ASSERT_TRUE(set.takeOverflow());
  std::vector<uint32_t> present;
  for (uint32_t id = 0; id < capacity + 1000; ++id) {
    if (isInSet(set.ref(), id)) present.push_back(id);
  }
  ASSERT_GT(present.size(), capacity / 2);
  set.grow(4);
  for (const uint32_t id : present) {
    ASSERT_TRUE(isInSet(set.ref(), id)) << id;
    ASSERT_EQ(set.ref().winner[findSlot(set.ref(), id)], id + 1);
  }
  for (uint32_t id = 0; id < capacity + 1000; ++id) insertHit(set.ref(), id, id + 1);
  EXPECT_FALSE(set.takeOverflow());
}

/// 2^16 slots times 2^16 are none in 32 bits.
TEST(HashSet, GrowingPastTheLargestTableIsAnError) {
  HostSet set(kTriangles, true);
  insertHit(set.ref(), 42, 9);
  for (const uint32_t factor : {1u << 16, 1u << 20, 1u << 31}) {
    try {
      set.grow(factor);
      FAIL() << factor;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("--set array"), std::string::npos) << error.what();
    }
    EXPECT_EQ(set.capacity(), kFirstHashCapacity);
    EXPECT_TRUE(isInSet(set.ref(), 42));
  }
}

TEST(HashSet, MixIsABijection) {
  for (uint32_t i = 0; i < 1u << 16; ++i) {
    // Invert the finaliser: each step is invertible.
    uint32_t h = murmurMix(i);
    h ^= h >> 16;
    h *= 0x7ed1b41du;
    h ^= (h >> 13) ^ (h >> 26);
    h *= 0xa5cb9243u;
    h ^= h >> 16;
    ASSERT_EQ(h, i);
  }
}

}  // namespace
}  // namespace sightline

#include "core/shared/halton.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace sightline {
namespace {

/// floor(2^24 * fraction) of the radical inverse with `digits` digits, shifted, in exact 128-bit arithmetic.
uint32_t reference(uint64_t index, uint32_t base, uint32_t digits, uint64_t period, uint32_t shift) {
  unsigned __int128 reversed = 0;
  uint64_t rest = index % period;
  for (uint32_t i = 0; i < digits; ++i) {
    reversed = reversed * base + rest % base;
    rest /= base;
  }
  reversed = (reversed + shift) % period;
  return static_cast<uint32_t>((reversed << 24) / period);
}

TEST(Halton, AgreesWithExactRadicalInverses) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200'000; ++i) {
    const uint64_t index = i < 1000 ? uint64_t(i) : random() >> (random() % 64);
    const uint32_t shift = static_cast<uint32_t>(random());
    const uint32_t shift3 = shift % kHaltonPeriod3, shift5 = shift % kHaltonPeriod5,
                   shift7 = shift % kHaltonPeriod7;
    ASSERT_EQ(halton2(index, shift), reference(index, 2, 32, uint64_t(1) << 32, shift))
        << index << ' ' << shift;
    // The scaling to 24 bits by one multiplication may round the last bit down, never up.
    const auto expectNear = [&](uint32_t value, uint32_t exact) {
      ASSERT_LE(value, exact) << "index " << index << " shift " << shift;
      ASSERT_GE(value + 1, exact) << "index " << index << " shift " << shift;
    };
    expectNear(halton3(index, shift3), reference(index, 3, 16, kHaltonPeriod3, shift3));
    expectNear(halton5(index, shift5), reference(index, 5, 12, kHaltonPeriod5, shift5));
    expectNear(halton7(index, shift7), reference(index, 7, 9, kHaltonPeriod7, shift7));
  }
}

TEST(Halton, FractionsStayBelowOne) {
  EXPECT_LT(haltonFraction(halton3(kHaltonPeriod3 - 1, 0)), 1.0f);
  EXPECT_LT(haltonFraction(halton5(kHaltonPeriod5 - 1, 0)), 1.0f);
  EXPECT_LT(haltonFraction(halton7(kHaltonPeriod7 - 1, 0)), 1.0f);
  EXPECT_LT(haltonFraction(halton2(0xffffffffu, 0)), 1.0f);
}

/// The reference implementation refreshed only a quarter of its points between iterations.
TEST(Halton, NoPointRepeatsAcrossThe32BitBorder) {
  std::set<std::array<uint32_t, 4>> seen;
  const auto add = [&](uint64_t index) {
    const std::array<uint32_t, 4> point{halton2(index, 5), halton3(index, 7), halton5(index, 11),
                                        halton7(index, 13)};
    ASSERT_TRUE(seen.insert(point).second) << "point " << index << " repeats";
  };
  for (uint64_t i = 0; i < 100'000; ++i) add(i);
  for (uint64_t i = 0; i < 100'000; ++i) add((uint64_t(1) << 32) + i);
  for (uint64_t i = 0; i < 100'000; ++i) add(uint64_t(kHaltonPeriod3) * 3 + i);
}

}  // namespace
}  // namespace sightline

// Floats as text that comes back as the same bits.
#include "core/io/float_text.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

namespace sightline {
namespace {

uint32_t bitsOf(float value) {
  return std::bit_cast<uint32_t>(value);
}

TEST(FloatText, ReadsBackWithoutLoss) {
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    const float some[] = {0.0f, -0.0f, 1.0f, -3.1f, 1e-45f, 3e38f, 0x1p-126f};
    const float value = i < 7 ? some[i] : std::bit_cast<float>(uint32_t(random()));
    ASSERT_EQ(bitsOf(*readFloat(bitsText(value))), bitsOf(value)) << bitsText(value);
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(bitsOf(*readFloat(hexFloat(value))), bitsOf(value)) << hexFloat(value);
    ASSERT_EQ(bitsOf(std::strtof(hexFloat(value).c_str(), nullptr)), bitsOf(value)) << hexFloat(value);
  }
  const glm::vec3 v(1.5f, -0.0f, 1e-42f);
  EXPECT_EQ(bitsText(v), "0x3fc00000,0x80000000,0x000002ca");
  EXPECT_EQ(bitsText(*readVector(bitsText(v))), bitsText(v));
}

TEST(FloatText, ReadsDecimalsHexadecimalsAndBits) {
  EXPECT_EQ(*readFloat("0.1"), 0.1f);
  EXPECT_EQ(*readFloat("-1e3"), -1000.0f);
  EXPECT_EQ(*readFloat("0x3f708000"), 0.9394531f);
  EXPECT_EQ(*readFloat("-0x1.8P1"), -3.0f);
  EXPECT_EQ(*readFloat("0x1.0000008p0"), 1.0f) << "the tie goes to even";
  EXPECT_TRUE(std::isinf(*readFloat("1e39")));
  for (const char* bad : {"", "-", "x", "0x", "0x3f70800", "0x3f7080000", "-0x3f708000", "0x1.8", "0x1p",
                          "1,", "1 ", "1 2", "--1", "0x0x1p0", "0x-1p0", "3f708000"}) {
    EXPECT_FALSE(readFloat(bad)) << bad;
  }
  EXPECT_EQ(*readVector("1,-2.5,0x40400000"), glm::vec3(1, -2.5f, 3));
  for (const char* bad : {"", "1", "1,2", "1,2,3,4", "1,2,", ",,", "1, 2,x"}) {
    EXPECT_FALSE(readVector(bad)) << bad;
  }
}

}  // namespace
}  // namespace sightline

// Sines, cosines, tangents and directions that do not depend on the C library.
#include "core/cell/rotation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace sightline {
namespace {

constexpr long double kPi = 3.14159265358979323846264338327950288L;

/// Distance of a double from the true value, in units of the double's last place.
double ulps(double value, long double truth) {
  const double spacing = std::nextafter(std::fabs(value), INFINITY) - std::fabs(value);
  return double(std::fabs((long double)(value)-truth) / spacing);
}

/// Sine by the C library in extended precision, near its zeros too; quarters: added to the angle.
long double sineOf(double degrees, int quarters) {
  const double turned = std::remainder(degrees, 360.0);
  const long double nearest = std::nearbyint(turned / 90);
  const long double x = (turned - nearest * 90) * kPi / 180;
  switch ((int(nearest) + quarters) & 3) {
    case 0:
      return sinl(x);
    case 1:
      return cosl(x);
    case 2:
      return -sinl(x);
    default:
      return -cosl(x);
  }
}

std::vector<double> manyAngles() {
  std::mt19937_64 random(5);
  std::vector<double> angles;
  for (int i = -1600; i <= 1600; ++i) angles.push_back(i * 0.5);
  std::uniform_real_distribution<double> turn(-400, 400), exponent(-40, 40);
  for (int i = 0; i < 300'000; ++i) {
    angles.push_back(turn(random));
    angles.push_back(std::copysign(std::exp2(exponent(random)), turn(random)));
    angles.push_back(90 * (i % 9 - 4) + turn(random) * std::exp2(-i % 60));
  }
  return angles;
}

TEST(Rotation, CosineAndSineAreWithinTwoUnitsInTheLastPlace) {
  double worst = 0;
  for (const double degrees : manyAngles()) {
    const CosSin at = cosSinDegrees(degrees);
    const double error = std::max(ulps(at.cosine, sineOf(degrees, 1)), ulps(at.sine, sineOf(degrees, 0)));
    ASSERT_LE(error, 1.5) << std::hexfloat << degrees << ": " << at.cosine << " " << at.sine;
    worst = std::max(worst, error);
  }
  EXPECT_GT(worst, 0.5) << "looked at something that rounds";
}

TEST(Rotation, MultiplesOfAQuarterTurnAreExact) {
  const double sines[] = {0, 1, 0, -1};
  for (int i = -4000; i <= 4000; ++i) {
    const CosSin at = cosSinDegrees(90.0 * i);
    EXPECT_EQ(at.cosine, sines[(i + 1) & 3]) << i;
    EXPECT_EQ(at.sine, sines[i & 3]) << i;
    EXPECT_FALSE(at.cosine == 0 && std::signbit(at.cosine)) << i;
    EXPECT_FALSE(at.sine == 0 && std::signbit(at.sine)) << i;
  }
  EXPECT_TRUE(std::isnan(cosSinDegrees(INFINITY).sine));
  EXPECT_TRUE(std::isnan(cosSinDegrees(NAN).cosine));
}

TEST(Rotation, TangentsAreWithinThreeUnitsInTheLastPlace) {
  for (const double degrees : manyAngles()) {
    const double angle = std::remainder(degrees, 179.9);
    ASSERT_LE(ulps(tanDegrees(angle), sineOf(angle, 0) / sineOf(angle, 1)), 3.0) << std::hexfloat << angle;
  }
}

TEST(Rotation, DirectionsAreWithinThreeUnitsInTheLastPlace) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> side(-1, 1), exponent(-60, 60);
  for (int i = 0; i < 500'000; ++i) {
    const double x = side(random), y = side(random) * (i % 2 ? 1 : std::exp2(exponent(random)));
    const double degrees = atan2Degrees(y, x);
    ASSERT_LE(ulps(degrees, atan2l(y, x) * 180 / kPi), 3.0) << std::hexfloat << y << " " << x;
  }
}

TEST(Rotation, MultiplesOfAnEighthTurnAreExactDirections) {
  for (const double s : {1e-300, 1.0, 3.7, 1e300}) {
    EXPECT_EQ(atan2Degrees(0, s), 0);
    EXPECT_EQ(atan2Degrees(s, s), 45);
    EXPECT_EQ(atan2Degrees(s, 0), 90);
    EXPECT_EQ(atan2Degrees(s, -s), 135);
    EXPECT_EQ(atan2Degrees(0, -s), 180);
    EXPECT_EQ(atan2Degrees(-s, -s), -135);
    EXPECT_EQ(atan2Degrees(-s, 0), -90);
    EXPECT_EQ(atan2Degrees(-s, s), -45);
  }
  EXPECT_EQ(atan2Degrees(0, 0), 0);
}

/// The same bits with every C library, compiler and processor: those of glibc 2.36 are others at 30 and 60.
TEST(Rotation, BitsAreFixed) {
  const struct {
    double degrees, cosine, sine;
  } turns[] = {{1, 0x1.ffec097f5af8ap-1, 0x1.1df0b2b89dd1ep-6},
               {20, 0x1.e11f642522d1cp-1, 0x1.5e3a8748a0bf5p-2},
               {30, 0x1.bb67ae8584caap-1, 0.5},
               {45, 0x1.6a09e667f3bccp-1, 0x1.6a09e667f3bcdp-1},
               {60, 0.5, 0x1.bb67ae8584caap-1},
               {123.456, -0x1.1a43870d371f9p-1, 0x1.ab2a9b25a9ab9p-1},
               {-77.7, 0x1.b4494670d7989p-3, -0x1.f43f5149cd4ebp-1},
               {1e6, 0x1.63a1a7e0b738ap-3, -0x1.f838b8c811c17p-1}};
  for (const auto& turn : turns) {
    EXPECT_EQ(cosSinDegrees(turn.degrees).cosine, turn.cosine) << turn.degrees;
    EXPECT_EQ(cosSinDegrees(turn.degrees).sine, turn.sine) << turn.degrees;
  }
  EXPECT_EQ(tanDegrees(30), 0x1.279a74590331dp-1);
  EXPECT_EQ(tanDegrees(89.5), 0x1.ca5ac71978af1p+6);
  EXPECT_EQ(atan2Degrees(1, 2), 0x1.a90a731a61dc4p+4);
  EXPECT_EQ(atan2Degrees(-1, 3), -0x1.26f58ce59e23cp+4);
  EXPECT_EQ(atan2Degrees(0.1, -0.7), 0x1.57bd63396788fp+7);
  EXPECT_EQ(atan2Degrees(5, -4), 0x1.0151d26331e54p+7);
}

}  // namespace
}  // namespace sightline

#include "core/voxel/exact_sign.h"

#include <CGAL/Exact_rational.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sightline {
namespace {

using Rational = CGAL::Exact_rational;

// Whole numbers, halves, numbers next to them, and specks: all that makes differences inexact and signs hang
// by a bit.
double hardNumber(std::mt19937_64& random) {
  const double whole = double(int(random() % 9) - 4);
  switch (random() % 5) {
    case 0:
      return whole;
    case 1:
      return whole / 2;
    case 2:
      return std::nextafter(whole + 8, 100.0) - 8;
    case 3:
      return std::ldexp(whole, -60);
    default:
      return whole + std::ldexp(double(int(random() % 3) - 1), -30);
  }
}

int signOf(const Rational& value) {
  return (value > 0) - (value < 0);
}

TEST(ExactSign, TellsTurnsInThePlaneAsRationalsDo) {
  std::mt19937_64 random(1);
  int zeros = 0;
  for (int i = 0; i < 20000; ++i) {
    double v[6];
    for (double& value : v) value = hardNumber(random);
    const Rational a = v[0], b = v[1], c = v[2], d = v[3], e = v[4], f = v[5];
    const int expected = signOf((a - e) * (d - f) - (b - f) * (c - e));
    zeros += expected == 0;
    ASSERT_EQ(orient2d(v[0], v[1], v[2], v[3], v[4], v[5]), expected)
        << v[0] << ' ' << v[1] << ' ' << v[2] << ' ' << v[3] << ' ' << v[4] << ' ' << v[5];
  }
  EXPECT_GT(zeros, 50);
}

TEST(ExactSign, TellsSidesOfAPlaneAsRationalsDo) {
  std::mt19937_64 random(2);
  int zeros = 0;
  for (int i = 0; i < 20000; ++i) {
    ExactPoint p[4];
    for (ExactPoint& point : p) {
      point.x = hardNumber(random);
      point.y = hardNumber(random);
      point.z = hardNumber(random);
    }
    if (i % 3 == 0) {  // in the plane of the others, by whole numbers
      p[3] = {p[0].x + 2 * (p[1].x - p[0].x) - (p[2].x - p[0].x),
              p[0].y + 2 * (p[1].y - p[0].y) - (p[2].y - p[0].y),
              p[0].z + 2 * (p[1].z - p[0].z) - (p[2].z - p[0].z)};
    }
    Rational d[3][3];
    for (int k = 0; k < 3; ++k) {
      d[k][0] = Rational(p[k + 1].x) - Rational(p[0].x);
      d[k][1] = Rational(p[k + 1].y) - Rational(p[0].y);
      d[k][2] = Rational(p[k + 1].z) - Rational(p[0].z);
    }
    const int expected = signOf((d[0][1] * d[1][2] - d[0][2] * d[1][1]) * d[2][0] +
                                (d[0][2] * d[1][0] - d[0][0] * d[1][2]) * d[2][1] +
                                (d[0][0] * d[1][1] - d[0][1] * d[1][0]) * d[2][2]);
    zeros += expected == 0;
    ASSERT_EQ(orient3d(p[0], p[1], p[2], p[3]), expected) << i;
  }
  EXPECT_GT(zeros, 50);
}

TEST(ExactSign, TellsTurnsAlongDiagonalsAndSignsOfSumsAsRationalsDo) {
  std::mt19937_64 random(3);
  int zeros = 0;
  for (int i = 0; i < 20000; ++i) {
    double v[9];
    for (double& value : v) value = hardNumber(random);
    const double d[3] = {double(int(random() % 3) - 1), double(int(random() % 3) - 1), 1};
    const Rational ux = Rational(v[0]) - v[6], uy = Rational(v[1]) - v[7], uz = Rational(v[2]) - v[8];
    const Rational vx = Rational(v[3]) - v[6], vy = Rational(v[4]) - v[7], vz = Rational(v[5]) - v[8];
    const Rational along =
        (uy * vz - uz * vy) * d[0] + (uz * vx - ux * vz) * d[1] + (ux * vy - uy * vx) * d[2];
    zeros += along == 0;
    ASSERT_EQ(orientAlong({d[0], d[1], d[2]}, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}),
              signOf(along))
        << i;
    const Rational sum = Rational(v[0]) + v[1] + v[2] + v[3];
    zeros += sum == 0;
    ASSERT_EQ(signOfSum(v[0], v[1], v[2], v[3]), signOf(sum)) << i;
  }
  EXPECT_GT(zeros, 50);
}

}  // namespace
}  // namespace sightline

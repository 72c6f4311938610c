#include "core/voxel/exact_sign.h"

#include <cmath>
#include <initializer_list>

namespace sightline {
namespace {

constexpr double kUnit = 0x1p-53;  // half a unit in the last place of 1
constexpr double kBound2 = (3 + 16 * kUnit) * kUnit;
constexpr double kBound3 = (7 + 56 * kUnit) * kUnit;

struct Pair {
  double high, low;
};

Pair sum(double a, double b) {
  const double high = a + b;
  const double b_part = high - a, a_part = high - b_part;
  return {high, (a - a_part) + (b - b_part)};
}

Pair difference(double a, double b) {
  return sum(a, -b);
}

Pair split(double a) {
  const double shifted = a * 134217729.0;  // 2^27 + 1
  const double high = shifted - (shifted - a);
  return {high, a - high};
}

Pair product(double a, double b) {
  const Pair x = split(a), y = split(b);
  const double high = a * b;
  return {high, ((x.high * y.high - high) + x.high * y.low + x.low * y.high) + x.low * y.low};
}

// An exact sum: doubles that do not overlap, smallest first, none zero.
template <int Capacity>
class Expansion {
 public:
  void add(double value) {
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      const Pair s = sum(value, parts_[i]);
      value = s.high;
      if (s.low != 0) parts_[kept++] = s.low;
    }
    if (value != 0) parts_[kept++] = value;
    count_ = kept;
  }
  void addProduct(double a, double b) {
    if (a == 0 || b == 0) return;
    const Pair p = product(a, b);
    add(p.low);
    add(p.high);
  }
  void addProduct(double a, double b, double c) {
    if (a == 0 || b == 0 || c == 0) return;
    const Pair p = product(a, b);
    addProduct(p.low, c);
    addProduct(p.high, c);
  }
  int sign() const { return count_ == 0 ? 0 : parts_[count_ - 1] < 0 ? -1 : 1; }

 private:
  double parts_[Capacity];
  int count_ = 0;
};

// Whether all are multiples of 2^-10: then differences are, products of two are of 2^-20 and of three of
// 2^-30, and sums that stay below 2^53 times that are computed without rounding. Scenes made on a grid are
// so, and they alone touch the lattice again and again.
template <typename... Values>
bool areCoarse(Values... values) {
  const auto isCoarse = [](double value) {
    const double scaled = value * 0x1p10;
    return std::abs(scaled) < 0x1p31 && double(int(scaled)) == scaled;
  };
  return (isCoarse(values) && ...);
}

int signOf(double value) {
  return (value > 0) - (value < 0);
}

// Sum of the eight products of a part each of two pairs, or minus it.
template <int Capacity>
void addProducts(Expansion<Capacity>& total, const Pair& a, const Pair& b, double factor) {
  for (const double x : {a.low, a.high}) {
    for (const double y : {b.low, b.high}) total.addProduct(x, factor * y);
  }
}

template <int Capacity>
void addProducts(Expansion<Capacity>& total, const Pair& a, const Pair& b, const Pair& c, double factor) {
  for (const double x : {a.low, a.high}) {
    for (const double y : {b.low, b.high}) {
      for (const double z : {c.low, c.high}) total.addProduct(x, y, factor * z);
    }
  }
}

int exact2d(double ax, double ay, double bx, double by, double cx, double cy) {
  Expansion<16> total;
  addProducts(total, difference(ax, cx), difference(by, cy), 1);
  addProducts(total, difference(ay, cy), difference(bx, cx), -1);
  return total.sign();
}

int exact3d(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& p) {
  const Pair u[3] = {difference(b.x, a.x), difference(b.y, a.y), difference(b.z, a.z)};
  const Pair v[3] = {difference(c.x, a.x), difference(c.y, a.y), difference(c.z, a.z)};
  const Pair w[3] = {difference(p.x, a.x), difference(p.y, a.y), difference(p.z, a.z)};
  Expansion<192> total;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    addProducts(total, u[j], v[k], w[i], 1);
    addProducts(total, u[k], v[j], w[i], -1);
  }
  return total.sign();
}

}  // namespace

int orient2d(double ax, double ay, double bx, double by, double cx, double cy) {
  const double left = (ax - cx) * (by - cy), right = (ay - cy) * (bx - cx);
  const double determinant = left - right;
  const double magnitude = std::abs(left) + std::abs(right);
  if (std::abs(determinant) > kBound2 * magnitude) return signOf(determinant);
  if (magnitude < 0x1p33 && areCoarse(ax, ay, bx, by, cx, cy)) return signOf(determinant);
  return exact2d(ax, ay, bx, by, cx, cy);
}

int orient3d(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& p) {
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
  const double vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  const double wx = p.x - a.x, wy = p.y - a.y, wz = p.z - a.z;
  const double yz = uy * vz, zy = uz * vy, zx = uz * vx, xz = ux * vz, xy = ux * vy, yx = uy * vx;
  const double determinant = (yz - zy) * wx + (zx - xz) * wy + (xy - yx) * wz;
  const double magnitude = (std::abs(yz) + std::abs(zy)) * std::abs(wx) +
                           (std::abs(zx) + std::abs(xz)) * std::abs(wy) +
                           (std::abs(xy) + std::abs(yx)) * std::abs(wz);
  if (std::abs(determinant) > kBound3 * magnitude) return signOf(determinant);
  if (magnitude < 0x1p23 && areCoarse(a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, p.x, p.y, p.z)) {
    return signOf(determinant);
  }
  return exact3d(a, b, c, p);
}

int orientAlong(const ExactPoint& d, const ExactPoint& a, const ExactPoint& b, const ExactPoint& c) {
  const double ux = a.x - c.x, uy = a.y - c.y, uz = a.z - c.z;
  const double vx = b.x - c.x, vy = b.y - c.y, vz = b.z - c.z;
  const double yz = uy * vz, zy = uz * vy, zx = uz * vx, xz = ux * vz, xy = ux * vy, yx = uy * vx;
  const double determinant = (yz - zy) * d.x + (zx - xz) * d.y + (xy - yx) * d.z;
  const double magnitude = (std::abs(yz) + std::abs(zy)) * std::abs(d.x) +
                           (std::abs(zx) + std::abs(xz)) * std::abs(d.y) +
                           (std::abs(xy) + std::abs(yx)) * std::abs(d.z);
  if (std::abs(determinant) > kBound3 * magnitude) return signOf(determinant);
  const Pair u[3] = {difference(a.x, c.x), difference(a.y, c.y), difference(a.z, c.z)};
  const Pair v[3] = {difference(b.x, c.x), difference(b.y, c.y), difference(b.z, c.z)};
  const double along[3] = {d.x, d.y, d.z};
  Expansion<48> total;
  for (int i = 0; i < 3; ++i) {
    if (along[i] == 0) continue;
    addProducts(total, u[(i + 1) % 3], v[(i + 2) % 3], along[i]);
    addProducts(total, u[(i + 2) % 3], v[(i + 1) % 3], -along[i]);
  }
  return total.sign();
}

int signOfSum(double a, double b, double c, double d) {
  const double sum = (a + b) + (c + d);
  if (std::abs(sum) > 4 * kUnit * (std::abs(a) + std::abs(b) + std::abs(c) + std::abs(d))) return signOf(sum);
  Expansion<4> total;
  for (const double value : {a, b, c, d}) total.add(value);
  return total.sign();
}

}  // namespace sightline

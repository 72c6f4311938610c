#include "core/generate/scan_surface.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/generate/generator_random.h"
#include "core/generate/noise.h"

namespace sightline {
namespace {

constexpr double kFinestWave = 4;       // edges
constexpr double kAround = 7;           // metres about the statue, and along its profile: of the sizes below
constexpr double kFirstWave = 1 / 1.3;  // metres, of the coarsest octave
constexpr float kReach = 0.22f;         // metres that the body is pushed in or out at most, about
constexpr float kScannerNoise = 0.15f;  // edges that a vertex is off at most
constexpr int kHoles = 24;

/// Radius and height of the profile, from the head down to the middle of the plinth's foot, in metres:
/// control points of a quadratic spline, about as far from each other.
constexpr std::array<glm::dvec2, 26> kProfile = {
    {{0, 5.75},    {0.30, 5.70}, {0.46, 5.35}, {0.40, 5.00}, {0.24, 4.70}, {0.55, 4.45}, {0.95, 4.25},
     {1.02, 3.85}, {0.85, 3.40}, {0.72, 2.95}, {0.85, 2.50}, {1.00, 2.05}, {1.06, 1.60}, {1.10, 1.20},
     {1.15, 0.85}, {1.18, 0.73}, {1.50, 0.70}, {1.85, 0.70}, {2.00, 0.67}, {2.03, 0.40}, {2.00, 0.05},
     {1.70, 0.00}, {1.30, 0.00}, {0.90, 0.00}, {0.50, 0.00}, {0, 0}}};
constexpr int kProfileEnd = int(kProfile.size()) - 1;
constexpr double kFoot = 13, kPlinth = 15;  // places in the profile: the body ends, the plinth begins

/// The profile goes on beyond the axis as its own mirror image: smooth there.
glm::dvec2 controlPoint(int i) {
  if (i < 0) return kProfile[size_t(-i)] * glm::dvec2(-1, 1);
  if (i > kProfileEnd) return kProfile[size_t(2 * kProfileEnd - i)] * glm::dvec2(-1, 1);
  return kProfile[size_t(i)];
}

struct ProfilePoint {
  glm::dvec2 place, normal;
};

ProfilePoint profileAt(double at) {
  const int i = std::clamp(int(at + 0.5), 0, kProfileEnd);
  const double f = at - i;
  const glm::dvec2 a = controlPoint(i - 1), b = controlPoint(i), c = controlPoint(i + 1);
  const glm::dvec2 tangent = (f - 0.5) * a - 2 * f * b + (0.5 + f) * c;
  return {0.5 * (0.5 - f) * (0.5 - f) * a + (0.75 - f * f) * b + 0.5 * (0.5 + f) * (0.5 + f) * c,
          glm::dvec2(-tangent.y, tangent.x) / std::sqrt(tangent.x * tangent.x + tangent.y * tangent.y)};
}

/// From the cube [-1, 1]^3's surface to the unit sphere: squares stay about as large as each other.
glm::dvec3 onSphere(const glm::dvec3& p) {
  const glm::dvec3 q = p * p;
  return {p.x * std::sqrt(1 - q.y / 2 - q.z / 2 + q.y * q.z / 3),
          p.y * std::sqrt(1 - q.z / 2 - q.x / 2 + q.z * q.x / 3),
          p.z * std::sqrt(1 - q.x / 2 - q.y / 2 + q.x * q.y / 3)};
}

/// The lattice with at most so many triangles, its three sizes as equal as can be: 4 (xy + yz + zx)
/// triangles.
glm::uvec3 latticeSize(uint64_t triangles) {
  uint64_t n = uint64_t(std::sqrt(double(triangles) / 12));
  while (12 * n * n > triangles) --n;
  while (12 * (n + 1) * (n + 1) <= triangles) ++n;
  const uint32_t y = 12 * n * n + 8 * n <= triangles ? 1 : 0,
                 x = 12 * n * n + 16 * n + 4 <= triangles ? 1 : 0;
  return glm::uvec3(uint32_t(n)) + glm::uvec3(x, y, 0);
}

uint32_t parts(uint32_t quads) {
  return (quads + ScanSurface::kPanelSide - 1) / ScanSurface::kPanelSide;
}

}  // namespace

ScanSurface::ScanSurface(uint64_t triangles, uint64_t seed, bool holes)
    : size_(latticeSize(triangles)), seed_(seed) {
  const double finest = kFinestWave * kAround / (4.0 * size_.z);
  for (double wave = kFirstWave / 2; wave >= finest; wave /= 2) ++octaves_;
  GeneratorRandom random(seed, 0x5ca2);
  while (holes && holes_.size() < kHoles) {
    const float x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    const double radius = double(random.uniform(0.02f, 0.09f));
    const glm::dvec3 p(x, y, z);
    const double square = glm::dot(p, p);
    if (square < 1 && square > 0.01) holes_.push_back({p / std::sqrt(square), radius});
  }
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const glm::uvec2 quads(size_[(axis + 1) % 3], size_[(axis + 2) % 3]);
    const glm::uvec2 count(parts(quads.x), parts(quads.y));
    for (uint32_t j = 0; j < count.y; ++j) {
      for (uint32_t i = 0; i < count.x; ++i) {
        const glm::uvec2 at(i, j);
        panels_.push_back(
            {"panel-" + std::to_string(side) + "-" + std::to_string(i) + "-" + std::to_string(j), axis,
             side % 2 == 1, at * quads / count, (at + 1u) * quads / count});
      }
    }
  }
}

uint32_t ScanSurface::vertexCount() const {
  return 2 * (size_.x * size_.y + size_.y * size_.z + size_.z * size_.x) + 2;
}

// Layers of the lattice along z: the lowest and highest whole, of the others the rim.
glm::uvec3 ScanSurface::latticePoint(uint32_t vertex) const {
  const uint32_t layer = (size_.x + 1) * (size_.y + 1), rim = 2 * (size_.x + size_.y);
  const auto ofLayer = [&](uint32_t at, uint32_t z) {
    return glm::uvec3(at % (size_.x + 1), at / (size_.x + 1), z);
  };
  if (vertex < layer) return ofLayer(vertex, 0);
  vertex -= layer;
  if (vertex >= rim * (size_.z - 1)) return ofLayer(vertex - rim * (size_.z - 1), size_.z);
  const uint32_t z = 1 + vertex / rim, sides = 2 * (size_.y - 1);
  uint32_t at = vertex % rim;
  if (at <= size_.x) return {at, 0, z};
  at -= size_.x + 1;
  if (at < sides) return {at % 2 == 0 ? 0 : size_.x, 1 + at / 2, z};
  return {at - sides, size_.y, z};
}

uint32_t ScanSurface::vertexAt(const glm::uvec3& point) const {
  const uint32_t layer = (size_.x + 1) * (size_.y + 1), rim = 2 * (size_.x + size_.y);
  const uint32_t in_layer = point.x + (size_.x + 1) * point.y;
  if (point.z == 0) return in_layer;
  const uint32_t before = layer + rim * (point.z - 1);
  if (point.z == size_.z) return before + in_layer;
  if (point.y == 0) return before + point.x;
  const uint32_t sides = before + size_.x + 1;
  if (point.y == size_.y) return sides + 2 * (size_.y - 1) + point.x;
  return sides + 2 * (point.y - 1) + (point.x == 0 ? 0 : 1);
}

glm::vec3 ScanSurface::position(uint32_t vertex) const {
  const glm::dvec3 d = onSphere(glm::dvec3(latticePoint(vertex)) / glm::dvec3(size_) * 2.0 - 1.0);
  // From the upper pole to the lower: about even in the angle, and in proportion to it at the poles.
  const double upper = std::sqrt(std::max(0.0, (1 - d.y) / 2)),
               lower = std::sqrt(std::max(0.0, (1 + d.y) / 2));
  const double at = upper / (upper + lower) * kProfileEnd;
  const double out = std::sqrt(d.x * d.x + d.z * d.z);
  const double cosine = out > 0 ? d.x / out : 1, sine = out > 0 ? d.z / out : 0;
  const auto [place, normal] = profileAt(at);
  const glm::vec3 base(place.x * cosine, place.y, place.x * sine);
  const float folds = 1 - 2 * std::fabs(noise3(base * glm::vec3(2.2f, 0.7f, 2.2f), seed_ + 100));
  const float detail = fractal3(base / float(kFirstWave), octaves_, seed_);
  const double of_body = 1 - 0.85 * std::clamp((at - kFoot) / (kPlinth - kFoot), 0.0, 1.0);
  const float reach = kReach * float(of_body * std::clamp(place.x / 0.9, 0.35, 1.0));
  const float noise = float(mixBits(mixBits(seed_ ^ 0x5ca4) + vertex) >> 40) * 0x1p-23f - 1;
  const double push = double(reach * (0.5f * folds + 0.4f * detail)) +
                      double(kScannerNoise * noise) * (kAround / (4.0 * size_.z));
  const double radius = place.x + push * normal.x;
  return {radius * cosine, place.y + push * normal.y, radius * sine};
}

/// Whether the quad lies in a hole, whose rim is uneven.
bool ScanSurface::isOpen(const Panel& panel, glm::uvec2 quad) const {
  if (holes_.empty()) return false;
  glm::dvec3 p(panel.high ? 1 : -1);
  for (int i = 0; i < 2; ++i) {
    const int axis = (panel.axis + 1 + i) % 3;
    p[axis] = (2.0 * quad[i] + 1) / size_[axis] - 1;
  }
  const glm::dvec3 d = onSphere(p);
  return std::ranges::any_of(holes_, [&](const Hole& hole) {
    const glm::dvec3 off = d - hole.direction;
    const double square = glm::dot(off, off), largest = 1.5 * hole.radius;
    if (square > largest * largest) return false;
    const double radius = hole.radius * (1 + 0.5 * double(noise3(glm::vec3(d * 40.0), seed_ + 200)));
    return square < radius * radius;
  });
}

template <typename Visit>
void ScanSurface::visitQuads(const Panel& panel, Visit&& visit) const {
  for (uint32_t v = panel.first.y; v < panel.end.y; ++v) {
    for (uint32_t u = panel.first.x; u < panel.end.x; ++u) {
      if (!isOpen(panel, {u, v})) visit(u, v);
    }
  }
}

uint32_t ScanSurface::triangleCount(const Panel& panel) const {
  uint32_t quads = 0;
  visitQuads(panel, [&](uint32_t, uint32_t) { ++quads; });
  return 2 * quads;
}

void ScanSurface::addTriangles(const Panel& panel, std::vector<glm::uvec3>& triangles) const {
  visitQuads(panel, [&](uint32_t u, uint32_t v) {
    const auto corner = [&](uint32_t du, uint32_t dv) {
      glm::uvec3 point(0);
      point[panel.axis] = panel.high ? size_[panel.axis] : 0;
      point[(panel.axis + 1) % 3] = u + du;
      point[(panel.axis + 2) % 3] = v + dv;
      return vertexAt(point);
    };
    const uint32_t a = corner(0, 0), c = corner(1, 1);
    const uint32_t b = panel.high ? corner(1, 0) : corner(0, 1), d = panel.high ? corner(0, 1) : corner(1, 0);
    triangles.emplace_back(a, b, c);
    triangles.emplace_back(a, c, d);
  });
}

}  // namespace sightline

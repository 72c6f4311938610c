#include "core/judge/ruling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "core/judge/seen_triangle.h"

namespace sightline {
namespace {

/// Half a unit in the last place of float, as a share.
constexpr double kFloatRounding = 0x1p-24;
/// Shares of the limit by which pieces are moved, in 26 directions.
constexpr double kTriedShares[] = {0.97, 0.11};

/// Distances at which the ray may meet the triangle when that is moved by up to `reach`: about where it meets
/// its plane, not beyond its corners.
DoubleRange possibleDistances(const Judge& judge, const JudgeRay& ray, uint32_t triangle, double reach) {
  const JudgeTriangle shape = judge.corners(triangle);
  const double length = glm::length(ray.direction), slack = reach / length;
  const auto along = [&](const glm::dvec3& corner) {
    return glm::dot((corner - ray.origin) / length, ray.direction / length);
  };
  const auto [nearest, farthest] = std::minmax({along(shape.a), along(shape.b), along(shape.c)});
  const DoubleRange corners{nearest - slack, farthest + slack};
  const auto plane = judge.planeDistance(ray, triangle);
  if (!plane) return corners;
  const glm::dvec3 normal = glm::cross(shape.b - shape.a, shape.c - shape.a);
  const double change = reach * glm::length(normal) / std::fabs(glm::dot(ray.direction, normal));
  if (!std::isfinite(change)) return corners;
  return {std::clamp(plane->low - change, corners.low, corners.high),
          std::clamp(plane->high + change, corners.low, corners.high)};
}

/// Looks for a way in which rounding lets a ray get to an answer.
class RoundingSearch {
 public:
  RoundingSearch(const Judge& judge, const JudgeRay& ray, double steps)
      : judge_(judge), ray_(ray), frame_(ray.direction), steps_(steps) {}

  /// Whether all triangles in the way (inTheWay(triangle)) that are surely nearer than `limit` and surely
  /// before the origin can be got past. radius: where to look for them, world units.
  template <typename InTheWay>
  bool canPassUpTo(double limit, double radius, const InTheWay& inTheWay) {
    findObstacles(limit, radius, inTheWay);
    joinPieces();
    for (size_t i = 0; i < obstacles_.size(); ++i) {
      if (pieceOf(i) == i && !canPass(i)) return false;
    }
    return true;
  }

 private:
  struct Obstacle {
    uint32_t triangle;
    SeenTriangle seen;
    double reach;  ///< by how much it may be moved, world units
  };

  template <typename InTheWay>
  void findObstacles(double limit, double radius, const InTheWay& inTheWay) {
    for (const uint32_t triangle : judge_.near(ray_, radius, limit)) {
      if (!inTheWay(triangle)) continue;
      const SeenTriangle seen(judge_.corners(triangle), ray_, frame_);
      const double reach = steps_ * floatStep(judge_, ray_, triangle);
      if (seen.distance() > reach) continue;
      const DoubleRange t = possibleDistances(judge_, ray_, triangle, reach);
      if (t.low > 0 && t.high < limit) obstacles_.push_back({triangle, seen, reach});
    }
  }

  /// Joins obstacles that share a corner or an edge where the ray passes.
  void joinPieces() {
    piece_.resize(obstacles_.size());
    std::iota(piece_.begin(), piece_.end(), size_t(0));
    std::map<std::array<double, 6>, size_t> owner;
    const auto join = [&](const glm::dvec3& p, const glm::dvec3& q, size_t obstacle) {
      std::array<double, 6> key{p.x, p.y, p.z, q.x, q.y, q.z};
      const auto [place, fresh] = owner.emplace(key, obstacle);
      if (!fresh) piece_[pieceOf(obstacle)] = pieceOf(place->second);
    };
    for (size_t i = 0; i < obstacles_.size(); ++i) {
      const JudgeTriangle t = judge_.corners(obstacles_[i].triangle);
      const glm::dvec3 corners[] = {t.a, t.b, t.c};
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 &p = corners[k], &q = corners[(k + 1) % 3];
        const Obstacle& its = obstacles_[i];
        if (glm::length(its.seen.corners[k]) <= 2 * its.reach) join(p, p, i);
        if (glm::length(its.seen.nearest_of_edge[k]) > its.reach) continue;
        const bool ordered = std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
        join(ordered ? p : q, ordered ? q : p, i);
      }
    }
  }

  size_t pieceOf(size_t obstacle) const {
    while (piece_[obstacle] != obstacle) obstacle = piece_[obstacle];
    return obstacle;
  }

  /// Whether a ray beside the given one passes the piece: the same as moving the piece.
  bool canPass(size_t piece) const {
    const auto passes = [&](const glm::dvec3& offset) {
      const JudgeRay moved{ray_.origin + offset, ray_.direction};
      for (size_t i = 0; i < obstacles_.size(); ++i) {
        if (pieceOf(i) == piece && judge_.meets(moved, obstacles_[i].triangle)) return false;
      }
      return true;
    };
    if (passes(glm::dvec3(0.0))) return true;
    double reach = 0;
    for (size_t i = 0; i < obstacles_.size(); ++i) {
      if (pieceOf(i) == piece) reach = std::max(reach, obstacles_[i].reach);
    }
    for (size_t i = 0; i < obstacles_.size(); ++i) {
      if (pieceOf(i) == piece && passesNextTo(obstacles_[i].seen, reach, passes)) return true;
    }
    return passesAnywhere(reach, passes);
  }

  /// Tries rays just beyond the edges of a triangle.
  template <typename Passes>
  bool passesNextTo(const SeenTriangle& seen, double reach, const Passes& passes) const {
    for (const glm::dvec2& place : seen.nearest_of_edge) {
      const double distance = glm::length(place);
      if (distance == 0 || distance > 0.9 * reach) continue;
      const glm::dvec2 beyond = place * (1 + 0.05 * reach / distance);
      if (passes(frame_.right * beyond.x + frame_.up * beyond.y)) return true;
    }
    return false;
  }

  template <typename Passes>
  bool passesAnywhere(double reach, const Passes& passes) const {
    for (const double share : kTriedShares) {
      for (int i = 0; i < 27; ++i) {
        const glm::dvec3 way(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (way == glm::dvec3(0.0)) continue;
        const glm::dvec3 offset = frame_.right * way.x + frame_.up * way.y + frame_.forward * way.z;
        if (passes(offset * (share * reach / glm::length(way)))) return true;
      }
    }
    return false;
  }

  const Judge& judge_;
  const JudgeRay& ray_;
  RayFrame frame_;
  double steps_;
  std::vector<Obstacle> obstacles_;
  std::vector<size_t> piece_;  ///< of an obstacle: another one of its piece, or itself
};

/// How many steps beside a ray that passes inside a triangle, through a hole of its mask or at its back,
/// there is something of it; infinite where there is nothing within the limit.
double stepsOutOfHole(const Judge& judge, const JudgeRay& ray, uint32_t triangle, double step,
                      const RoundingLimit& limit) {
  const RayFrame frame(ray.direction);
  for (double steps = limit.steps / 16; steps <= limit.steps; steps *= 2) {
    for (int i = 0; i < 9; ++i) {
      const double x = i % 3 - 1, y = i / 3 - 1;
      if (x == 0 && y == 0) continue;
      const glm::dvec3 offset = (frame.right * x + frame.up * y) * (steps * step / std::sqrt(x * x + y * y));
      if (judge.meets({ray.origin + offset, ray.direction}, triangle)) return steps;
    }
  }
  return HUGE_VAL;
}

/// How many float steps the ray passes beside the triangle; 0: it meets it.
double stepsBeside(const Judge& judge, const JudgeRay& ray, uint32_t triangle, const RoundingLimit& limit) {
  if (judge.meets(ray, triangle)) return 0;
  const double step = floatStep(judge, ray, triangle);
  const double steps = SeenTriangle(judge.corners(triangle), ray, RayFrame(ray.direction)).distance() / step;
  if (steps == 0 && judge.isPassable(triangle)) return stepsOutOfHole(judge, ray, triangle, step, limit);
  return steps;
}

}  // namespace

double floatStep(const Judge& judge, const JudgeRay& ray, uint32_t triangle) {
  const JudgeTriangle t = judge.corners(triangle);
  return kFloatRounding *
         std::max({maxAbs(t.a - ray.origin), maxAbs(t.b - ray.origin), maxAbs(t.c - ray.origin)});
}

Ruling rule(const Judge& judge, const Ray& float_ray, const Hit& answer, const ExactHit& exact,
            const RoundingLimit& limit, bool judge_distance) {
  const JudgeRay ray = judgeRay(float_ray);
  const bool hit = answer.triangle != kNoTriangle;
  if (!hit && exact.missed()) return {};
  if (hit && (answer.triangle >= judge.triangleCount() || (judge_distance && !(answer.t > 0))))
    return {Verdict::kWrong, HUGE_VAL};

  double farthest = HUGE_VAL;  // what is surely nearer hides the answer
  double radius = 0;
  Ruling ruling;
  if (hit) {
    const double step = floatStep(judge, ray, answer.triangle);
    if (!exact.contains(answer.triangle))
      ruling.steps_beside = stepsBeside(judge, ray, answer.triangle, limit);
    const DoubleRange t = possibleDistances(judge, ray, answer.triangle, limit.steps * step);
    const double rounding = std::fabs(t.high) * 4 * kFloatRounding;
    const bool far = judge_distance && (answer.t < t.low - rounding || answer.t > t.high + rounding);
    if (ruling.steps_beside > limit.steps || t.high <= 0 || far) {
      ruling.verdict = Verdict::kWrong;
      return ruling;
    }
    if (exact.contains(answer.triangle)) return ruling;
    farthest = t.low;
    radius = limit.steps * step;
  }
  for (const uint32_t triangle : exact.triangles) {
    radius = std::max(radius, limit.steps * floatStep(judge, ray, triangle));
  }
  const bool rounded =
      RoundingSearch(judge, ray, limit.steps).canPassUpTo(farthest, radius, [&](uint32_t triangle) {
        return !judge.isGlass(triangle);  // nothing is behind glass
      });
  ruling.verdict = rounded ? Verdict::kRounded : Verdict::kMissed;
  return ruling;
}

Ruling ruleGlass(const Judge& judge, const Ray& float_ray, const Hit& answer, std::span<const uint32_t> glass,
                 const ExactHit& exact, const RoundingLimit& limit) {
  const JudgeRay ray = judgeRay(float_ray);
  const bool hit = answer.triangle != kNoTriangle;
  if (hit && answer.triangle >= judge.triangleCount()) return {};
  const std::vector<uint32_t> seen = judge.glassBefore(ray, exact);
  const bool ends_right = hit ? exact.contains(answer.triangle) : exact.missed();
  if (ends_right && std::ranges::equal(seen, glass)) return {};

  DoubleRange end{HUGE_VAL, HUGE_VAL};  // where the ray ends, up to rounding
  if (hit) {
    const double reach = limit.steps * floatStep(judge, ray, answer.triangle);
    end = possibleDistances(judge, ray, answer.triangle, reach);
  }
  Ruling ruling;
  double radius = 0;
  for (const uint32_t triangle : glass) {
    if (triangle >= judge.triangleCount() || !judge.isGlass(triangle)) return {Verdict::kWrong, HUGE_VAL};
    const double reach = limit.steps * floatStep(judge, ray, triangle);
    radius = std::max(radius, reach);
    if (std::ranges::binary_search(seen, triangle)) continue;
    const double steps = stepsBeside(judge, ray, triangle, limit);
    ruling.steps_beside = std::max(ruling.steps_beside, steps);
    const DoubleRange t = possibleDistances(judge, ray, triangle, reach);
    if (steps > limit.steps || t.high <= 0 || t.low > end.high) {
      ruling.verdict = Verdict::kWrong;
      return ruling;
    }
    ruling.verdict = Verdict::kRounded;
  }
  for (const uint32_t triangle : seen) {
    radius = std::max(radius, limit.steps * floatStep(judge, ray, triangle));
    if (!std::ranges::binary_search(glass, triangle)) ruling.verdict = Verdict::kRounded;
  }
  const auto left_out = [&](uint32_t triangle) {
    return judge.isGlass(triangle) && !std::ranges::binary_search(glass, triangle);
  };
  if (!RoundingSearch(judge, ray, limit.steps).canPassUpTo(end.low, radius, left_out))
    ruling.verdict = Verdict::kMissed;
  return ruling;
}

Ruling ruleSight(const Judge& judge, const Ray& ray, const Hit& answer, std::span<const uint32_t> glass,
                 const ExactHit& exact, const RoundingLimit& limit) {
  const Ruling end = rule(judge, ray, answer, exact, limit);
  if (!judge.hasGlass() || end.verdict == Verdict::kMissed || end.verdict == Verdict::kWrong) return end;
  const Ruling before = ruleGlass(judge, ray, answer, glass, exact, limit);
  if (before.verdict < end.verdict) return end;
  if (end.verdict < before.verdict) return before;
  return before.steps_beside > end.steps_beside ? before : end;
}

}  // namespace sightline

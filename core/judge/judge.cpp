#include "core/judge/judge.h"

#include <algorithm>
#include <cmath>

#include "core/judge/contact_filter.h"
#include "core/judge/exact_contact.h"
#include "core/judge/surface_contact.h"

namespace sightline {
namespace {

/// A range of this share of its number is narrow against a unit in the last place of float (2^-24).
constexpr double kNarrow = 0x1p-40;

/// A triangle that is met, perhaps first.
struct Candidate {
  uint32_t triangle;
  DoubleRange t;
};

/// Those of the candidates, all of which are met, that are met first.
ExactHit firstOf(const JudgeRay& ray, const Judge& judge, std::vector<Candidate> candidates, double limit) {
  std::erase_if(candidates, [&](const Candidate& c) { return c.t.low > limit; });
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.triangle < b.triangle; });
  const auto same = [](const Candidate& a, const Candidate& b) { return a.triangle == b.triangle; };
  candidates.erase(std::unique(candidates.begin(), candidates.end(), same), candidates.end());

  ExactHit hit;
  if (candidates.empty()) return hit;
  hit.t = candidates.front().t;
  hit.triangles = {candidates.front().triangle};
  if (candidates.size() == 1) return hit;
  auto best = *exactPlaneDistance(ray, judge.corners(candidates.front().triangle));
  for (size_t i = 1; i < candidates.size(); ++i) {
    auto t = *exactPlaneDistance(ray, judge.corners(candidates[i].triangle));
    const int order = compare(t, best);
    if (order > 0) continue;
    if (order < 0) {
      best = std::move(t);
      hit.triangles.clear();
      hit.t = candidates[i].t;
    }
    hit.triangles.push_back(candidates[i].triangle);
  }
  return hit;
}

}  // namespace

bool ExactHit::contains(uint32_t triangle) const {
  return std::binary_search(triangles.begin(), triangles.end(), triangle);
}

Judge::Judge(const Scene& scene, const Bvh& bvh)
    : scene_(scene), candidates_(bvh), has_glass_(featuresOf(scene.surfaces).glass) {}

JudgeTriangle Judge::corners(uint32_t triangle) const {
  const auto t = scene_.corners(triangle);
  return {glm::dvec3(t[0]), glm::dvec3(t[1]), glm::dvec3(t[2])};
}

ExactHit Judge::nearest(const JudgeRay& ray) const {
  std::vector<Candidate> met;
  double limit = HUGE_VAL;  // the first triangle is not beyond it
  const auto visit = [&](uint32_t triangle) {
    if (isGlass(triangle)) return;
    const JudgeTriangle shape = corners(triangle);
    FilteredContact contact = filterContact(ray, shape, limit);
    if (contact.certainty == Certainty::kMiss) return;
    if (contact.certainty == Certainty::kUnsure) {
      const auto t = exactContact(ray, shape);
      if (!t) return;
      contact.t = rangeOf(*t);
    }
    if (!meetsSurface(scene_, triangle, ray, shape)) return;
    limit = std::min(limit, contact.t.high);
    met.push_back({triangle, contact.t});
  };
  candidates_.walk(ray, 0, visit, [&] { return limit; });
  return firstOf(ray, *this, std::move(met), limit);
}

bool Judge::meets(const JudgeRay& ray, uint32_t triangle) const {
  const JudgeTriangle shape = corners(triangle);
  const FilteredContact contact = filterContact(ray, shape, HUGE_VAL);
  if (contact.certainty == Certainty::kMiss) return false;
  if (contact.certainty == Certainty::kUnsure && !exactContact(ray, shape)) return false;
  return meetsSurface(scene_, triangle, ray, shape);
}

std::vector<uint32_t> Judge::glassBefore(const JudgeRay& ray, const ExactHit& end) const {
  std::vector<uint32_t> glass;
  if (!has_glass_) return glass;
  const double limit = end.missed() ? HUGE_VAL : end.t.high;
  const auto visit = [&](uint32_t triangle) {
    if (isGlass(triangle) && meets(ray, triangle) && !isBehind(ray, triangle, end)) glass.push_back(triangle);
  };
  candidates_.walk(ray, 0, visit, [=] { return limit; });
  std::sort(glass.begin(), glass.end());
  glass.erase(std::unique(glass.begin(), glass.end()), glass.end());
  return glass;
}

bool Judge::isBehind(const JudgeRay& ray, uint32_t triangle, const ExactHit& end) const {
  if (end.missed()) return false;
  return compare(*exactPlaneDistance(ray, corners(triangle)),
                 *exactPlaneDistance(ray, corners(end.triangles.front()))) > 0;
}

bool Judge::sees(const JudgeRay& ray, uint32_t triangle) const {
  if (!isGlass(triangle)) return nearest(ray).contains(triangle);
  return meets(ray, triangle) && !isBehind(ray, triangle, nearest(ray));
}

std::vector<uint32_t> Judge::near(const JudgeRay& ray, double reach, double limit) const {
  std::vector<uint32_t> triangles;
  candidates_.walk(
      ray, reach, [&](uint32_t triangle) { triangles.push_back(triangle); }, [=] { return limit; });
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

std::optional<DoubleRange> Judge::planeDistance(const JudgeRay& ray, uint32_t triangle) const {
  const JudgeTriangle shape = corners(triangle);
  DoubleRange t;
  if (filterPlaneDistance(ray, shape, t) && t.high - t.low <= kNarrow * std::fabs(t.low)) return t;
  const auto exact = exactPlaneDistance(ray, shape);
  if (!exact) return std::nullopt;
  return rangeOf(*exact);
}

}  // namespace sightline

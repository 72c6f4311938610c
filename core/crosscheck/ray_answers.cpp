#include "core/crosscheck/ray_answers.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/crosscheck/difference.h"
#include "core/io/float_text.h"
#include "core/shared/vector.h"
#include "core/trace/sights.h"

namespace sightline {
Json hexVector(const vec3& v) {
  return {hexFloat(v.x), hexFloat(v.y), hexFloat(v.z)};
}

bool RayAnswers::anyGlass() const {
  return !exact_glass.empty() ||
         std::any_of(glass.begin(), glass.end(), [](const auto& its) { return !its.empty(); });
}

bool RayAnswers::differ() const {
  return std::any_of(hits.begin(), hits.end(),
                     [&](const Hit& hit) { return hit.triangle != hits.front().triangle; }) ||
         std::any_of(glass.begin(), glass.end(), [&](const auto& its) { return its != glass.front(); });
}

bool RayAnswers::legal() const {
  return std::all_of(rulings.begin(), rulings.end(), [](const Ruling& ruling) {
    return ruling.verdict == Verdict::kRight || ruling.verdict == Verdict::kRounded;
  });
}

RayAnswers askAll(const Judge& judge, const Ray& ray, std::span<Tracer* const> devices,
                  const RoundingLimit& limit) {
  RayAnswers answers;
  answers.ray = ray;
  answers.exact = judge.nearest(judgeRay(ray));
  answers.exact_glass = judge.glassBefore(judgeRay(ray), answers.exact);
  for (Tracer* device : devices) {
    Sights sights;
    sights.trace(*device, {&ray, 1});
    const Hit hit = sights.hits().front();
    answers.hits.push_back(hit);
    answers.glass.push_back(sights.glassIds(0));
    answers.rulings.push_back(ruleSight(judge, ray, hit, answers.glass.back(), answers.exact, limit));
  }
  return answers;
}

Json answersJson(std::span<const Hit> hits, std::span<const Ruling> rulings,
                 std::span<const std::string> devices) {
  Json json = Json::array();
  for (size_t d = 0; d < devices.size(); ++d) {
    const bool missed = hits[d].triangle == kNoTriangle;
    json.push_back({{"device", devices[d]},
                    {"triangle", missed ? Json(nullptr) : Json(hits[d].triangle)},
                    {"t", missed ? Json(nullptr) : Json(hexFloat(hits[d].t))},
                    {"verdict", verdictName(rulings[d].verdict)},
                    {"steps_beside", rulings[d].steps_beside}});
  }
  return json;
}

void addAnswers(Json& json, const RayAnswers& answers, std::span<const std::string> devices) {
  json["origin"] = hexVector(xyz3(answers.ray.origin));
  json["direction"] = hexVector(xyz3(answers.ray.direction));
  json["exact_triangles"] = answers.exact.triangles;
  json["exact_t"] = answers.exact.missed() ? Json(nullptr) : Json(answers.exact.t.low);
  json["answers"] = answersJson(answers.hits, answers.rulings, devices);
  if (!answers.anyGlass()) return;
  json["exact_glass"] = answers.exact_glass;
  for (size_t d = 0; d < devices.size(); ++d) json["answers"][d]["glass"] = answers.glass[d];
}

namespace {

std::string glassText(std::span<const uint32_t> glass) {
  return glass.empty() ? "" : fmt::format(", through glass {}", fmt::join(glass, ", "));
}

}  // namespace

std::string answerText(const Hit& hit, std::span<const uint32_t> glass) {
  if (hit.triangle == kNoTriangle) return "nothing" + glassText(glass);
  return fmt::format("triangle {} at {}{}", hit.triangle, hexFloat(hit.t), glassText(glass));
}

std::string exactText(const ExactHit& exact, std::span<const uint32_t> glass) {
  if (exact.missed()) return "nothing" + glassText(glass);
  return fmt::format(
      "triangle {}{} at {:.9g}{}", exact.triangles.front(),
      exact.triangles.size() > 1 ? fmt::format(" and {} more", exact.triangles.size() - 1) : "", exact.t.low,
      glassText(glass));
}

std::string hexText(const vec3& v) {
  return hexFloat(v.x) + " " + hexFloat(v.y) + " " + hexFloat(v.z);
}

}  // namespace sightline

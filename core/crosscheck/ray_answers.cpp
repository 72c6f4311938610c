#include "core/crosscheck/ray_answers.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/crosscheck/difference.h"
#include "core/io/float_text.h"
#include "core/shared/vector.h"

namespace sightline {
namespace {

Json hexVector(const vec3& v) {
  return {hexFloat(v.x), hexFloat(v.y), hexFloat(v.z)};
}

}  // namespace

bool RayAnswers::differ() const {
  return std::any_of(hits.begin(), hits.end(),
                     [&](const Hit& hit) { return hit.triangle != hits.front().triangle; });
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
  for (Tracer* device : devices) {
    Hit hit{};
    device->traceRays({&ray, 1}, {&hit, 1});
    answers.hits.push_back(hit);
    answers.rulings.push_back(rule(judge, ray, hit, answers.exact, limit));
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
}

std::string answerText(const Hit& hit) {
  if (hit.triangle == kNoTriangle) return "nothing";
  return fmt::format("triangle {} at {}", hit.triangle, hexFloat(hit.t));
}

std::string exactText(const ExactHit& exact) {
  if (exact.missed()) return "nothing";
  return fmt::format(
      "triangle {}{} at {:.9g}", exact.triangles.front(),
      exact.triangles.size() > 1 ? fmt::format(" and {} more", exact.triangles.size() - 1) : "", exact.t.low);
}

std::string hexText(const vec3& v) {
  return hexFloat(v.x) + " " + hexFloat(v.y) + " " + hexFloat(v.z);
}

}  // namespace sightline

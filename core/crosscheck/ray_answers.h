#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/bake/cell_json.h"
#include "core/judge/ruling.h"
#include "core/trace/tracer.h"

namespace sightline {

/// A ray with what several devices and the judge say to it.
struct RayAnswers {
  Ray ray{};
  std::vector<Hit> hits;                     ///< by device: what ends the ray
  std::vector<std::vector<uint32_t>> glass;  ///< by device: what it sees before that, ascending
  std::vector<Ruling> rulings;               ///< by device: on both
  ExactHit exact;
  std::vector<uint32_t> exact_glass;

  /// Whether anyone says that the ray sees glass.
  bool anyGlass() const;
  /// Whether two devices name different triangles.
  bool differ() const;
  /// Whether each answer is right, if only up to rounding: none missed, none wrong.
  bool legal() const;
};

/// Traces the ray on all devices, which hold the judge's scene. Its direction is not zero, all is finite.
RayAnswers askAll(const Judge& judge, const Ray& ray, std::span<Tracer* const> devices,
                  const RoundingLimit& limit = {});

/// Adds "origin", "direction", "exact_triangles", "exact_t" and "answers"; where anyone sees glass,
/// "exact_glass" and "glass" of each answer, too. devices: their ids.
void addAnswers(Json& json, const RayAnswers& answers, std::span<const std::string> devices);
/// "answers" alone: device, triangle, t, verdict, steps_beside.
Json answersJson(std::span<const Hit> hits, std::span<const Ruling> rulings,
                 std::span<const std::string> devices);

/// "triangle 4 at 0x1p+0", "nothing"; with glass: "triangle 4 at 0x1p+0, through glass 1, 7".
std::string answerText(const Hit& hit, std::span<const uint32_t> glass = {});
std::string exactText(const ExactHit& exact, std::span<const uint32_t> glass = {});
/// ["0x1p+0", "0x0p+0", "-0x1.8p+1"]
Json hexVector(const vec3& v);
/// "0x1p+0 0x0p+0 -0x1.8p+1"
std::string hexText(const vec3& v);

}  // namespace sightline

#include "core/scene/instance_record.h"

#include <limits>

namespace sightline {
namespace {

constexpr double kUnit = 0x1p-24;
/// Doubles round what is summed up here a few times.
constexpr double kUp = 1 + 0x1p-40;

float roundedUp(double value) {
  const auto nearest = static_cast<float>(value);
  return nearest < value ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest;
}

}  // namespace

InstanceRecord recordOf(const Placement& place, const Bounds& bounds) {
  InstanceRecord record{};
  record.place = place;
  const glm::dmat3 inverse = glm::inverse(linearPart(place));
  const double sum = largestSum(place, bounds);
  const glm::dvec3 reach = reachOf(bounds);
  vec4* const rows[3] = {&record.local_x, &record.local_y, &record.local_z};
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 row(inverse[0][axis], inverse[1][axis], inverse[2][axis]);
    const double row_sum = (std::abs(row.x) + std::abs(row.y) + std::abs(row.z)) * kUp;
    *rows[axis] = vec4(glm::vec3(row), roundedUp(row_sum));
    record.padding[axis] = roundedUp(kUnit * 8 * (row_sum * sum + reach[axis]) * kUp);
  }
  return record;
}

}  // namespace sightline

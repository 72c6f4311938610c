#include "core/sampling/hemicube.h"

#include <algorithm>
#include <limits>

#include "core/shared/halton.h"
#include "core/shared/vector.h"

namespace sightline {
namespace {

ViewFrame frameOf(glm::vec3 origin, glm::vec3 forward, glm::vec3 up) {
  return {vec4(origin, 0), vec4(forward, 0), vec4(glm::cross(forward, up), 0), vec4(up, 0)};
}

double areaOf(const Face& face) {
  return double(length3(xyz3(face.edge_u))) * double(length3(xyz3(face.edge_v)));
}

/// From a 24-bit Halton number.
float unit(uint number) {
  return float(number) * 0x1p-24f;
}

/// The face at `place` (0 .. 1) of the faces laid side by side.
const Face& faceAt(std::span<const Face> faces, double place) {
  double total = 0;
  for (const Face& face : faces) total += areaOf(face);
  double left = place * total;
  for (const Face& face : faces) {
    left -= areaOf(face);
    if (left < 0) return face;
  }
  return faces.back();
}

}  // namespace

Hemicube hemicubeAt(const Face& face, glm::vec3 point) {
  const glm::vec3 u = xyz3(face.axis_u), v = xyz3(face.axis_v), normal = xyz3(face.normal);
  return {frameOf(point, normal, v), frameOf(point, u, normal), frameOf(point, -u, normal),
          frameOf(point, v, normal), frameOf(point, -v, normal)};
}

Hemicube placeHemicube(std::span<const Face> faces, uint64_t index, uvec4 shifts) {
  const Face& face = faceAt(faces, double(unit(halton2(index, shifts.x))));
  const glm::vec3 along = unit(halton3(index, shifts.y)) * xyz3(face.edge_u);
  const glm::vec3 across = unit(halton5(index, shifts.z)) * xyz3(face.edge_v);
  return hemicubeAt(face, xyz3(face.corner) + along + across);
}

float hemicubeNear(const Scene& scene, std::span<const Face> faces) {
  glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
  const auto include = [&](glm::vec3 point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  };
  for (const glm::vec3& point : scene.positions) include(point);
  float shortest = std::numeric_limits<float>::max();
  for (const Face& face : faces) {
    const glm::vec3 corner = xyz3(face.corner), u = xyz3(face.edge_u), v = xyz3(face.edge_v);
    include(corner);
    include(corner + u + v);
    shortest = std::min({shortest, length3(u), length3(v)});
  }
  return std::min(length3(high - low) * 0x1p-16f, shortest * 0x1p-8f);
}

}  // namespace sightline

#include "core/generate/rim.h"

#include <algorithm>

namespace sightline {

Rim rimOf(const std::array<uint32_t, 4>& corners) {
  Rim rim;
  for (size_t i = 0; i < 4; ++i) rim.sides[i] = {corners[i], corners[(i + 1) & 3]};
  return rim;
}

void closeBetween(MeshBuilder& mesh, const Seam& a, const Seam& b) {
  const size_t steps_a = a.size() - 1, steps_b = b.size() - 1;
  for (size_t i = 0, j = 0; i < steps_a || j < steps_b;) {
    // Whichever is behind goes on.
    if (j == steps_b || (i < steps_a && (i + 1) * steps_b <= (j + 1) * steps_a)) {
      mesh.triangle(a[i], b[j], a[i + 1]);
      ++i;
    } else {
      mesh.triangle(a[i], b[j], b[j + 1]);
      ++j;
    }
  }
}

void closeBetween(MeshBuilder& mesh, const Rim& below, const Rim& above) {
  for (size_t i = 0; i < 4; ++i) closeBetween(mesh, above.sides[i], below.sides[i]);
}

void closeFan(MeshBuilder& mesh, uint32_t middle, std::span<const uint32_t> polygon) {
  for (size_t i = 0; i < polygon.size(); ++i) {
    mesh.triangle(middle, polygon[i], polygon[i + 1 == polygon.size() ? 0 : i + 1]);
  }
}

void closeCap(MeshBuilder& mesh, const Rim& rim, uint32_t middle, bool other_way) {
  std::vector<uint32_t> polygon;
  for (const Seam& side : rim.sides) polygon.insert(polygon.end(), side.begin(), side.end() - 1);
  if (other_way) std::ranges::reverse(polygon);
  closeFan(mesh, middle, polygon);
}

void closedBlock(MeshBuilder& mesh, glm::vec3 low, glm::vec3 high, uint32_t nu, uint32_t nv) {
  const uint32_t first = uint32_t(mesh.vertexCount()), columns = nu + 1;
  const glm::vec3 size = high - low;
  mesh.patch({low.x, high.y, high.z}, {size.x, 0, 0}, {0, 0, -size.z}, nu, nv);
  Rim top;
  for (uint32_t i = 0; i <= nu; ++i) {
    top.sides[0].push_back(first + i);
    top.sides[2].push_back(first + nv * columns + nu - i);
  }
  for (uint32_t j = 0; j <= nv; ++j) {
    top.sides[1].push_back(first + j * columns + nu);
    top.sides[3].push_back(first + (nv - j) * columns);
  }
  const uint32_t bottom = mesh.vertex({low.x, low.y, high.z});
  mesh.vertex({high.x, low.y, high.z});
  mesh.vertex({high.x, low.y, low.z});
  mesh.vertex({low.x, low.y, low.z});
  closeBetween(mesh, rimOf({bottom, bottom + 1, bottom + 2, bottom + 3}), top);
  mesh.quad(bottom + 3, bottom + 2, bottom + 1, bottom);
}

}  // namespace sightline

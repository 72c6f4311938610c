#pragma once
// Scenes and cells on which tracers and bakes go wrong; docs/numerics.md has a row for each.
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/cell/view_cell.h"
#include "core/scene/scene.h"
#include "tests/support/boxes.h"

namespace sightline::hard {

struct HardCase {
  std::string name;
  Scene scene;
  ViewCell cell;
};

class Numbers {
 public:
  explicit Numbers(uint32_t seed) : engine_(seed) {}
  double unit() { return double(engine_() >> 8) * 0x1p-24; }
  glm::dvec3 point() {
    const double x = unit(), y = unit(), z = unit();
    return glm::dvec3(x, y, z) * 2.0 - 1.0;
  }

 private:
  std::mt19937 engine_;
};

inline void addTriangle(Scene& scene, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const auto first = uint32_t(scene.positions.size());
  for (const glm::dvec3& p : {a, b, c}) scene.positions.emplace_back(p);
  scene.triangles.push_back({first, first + 1, first + 2});
}

/// A grid of (columns + 1) * (rows + 1) shared vertices.
template <typename Place>
void addGrid(Scene& scene, uint32_t columns, uint32_t rows, const Place& place) {
  const auto first = uint32_t(scene.positions.size());
  for (uint32_t y = 0; y <= rows; ++y) {
    for (uint32_t x = 0; x <= columns; ++x)
      scene.positions.emplace_back(place(double(x) / columns, double(y) / rows));
  }
  for (uint32_t y = 0; y < rows; ++y) {
    for (uint32_t x = 0; x < columns; ++x) {
      const uint32_t i = first + y * (columns + 1) + x, below = i + columns + 1;
      scene.triangles.push_back({i, i + 1, below});
      scene.triangles.push_back({i + 1, below + 1, below});
    }
  }
}

inline Scene sphere() {
  Scene scene;
  addGrid(scene, 32, 20, [](double u, double v) {
    const double azimuth = u == 1 ? 0 : 2 * std::numbers::pi * u, polar = std::numbers::pi * v;
    const double radius = v == 0 || v == 1 ? 0 : std::sin(polar);
    return glm::dvec3(radius * std::cos(azimuth), std::cos(polar), radius * std::sin(azimuth));
  });
  return scene;
}

inline Scene cube() {
  Scene scene;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      addGrid(scene, 8, 8, [&](double u, double v) {
        glm::dvec3 p;
        p[axis] = side;
        p[(axis + 1) % 3] = 2 * u - 1;
        p[(axis + 2) % 3] = 2 * v - 1;
        return p;
      });
    }
  }
  return scene;
}

inline Scene terrain() {
  Scene scene;
  addGrid(scene, 30, 30, [](double u, double v) {
    const double height = std::sin(13 * u) * std::cos(11 * v) + 0.3 * std::sin(40 * u * v);
    return glm::dvec3(2 * u - 1, 0.2 * height - 0.7, 2 * v - 1);
  });
  return scene;
}

/// Random triangles; width: of slivers, as a share of their length.
inline Scene soup(uint32_t count, double size, double width, uint32_t seed) {
  Scene scene;
  Numbers numbers(seed);
  for (uint32_t i = 0; i < count; ++i) {
    const glm::dvec3 a = numbers.point(), b = a + numbers.point() * size;
    const glm::dvec3 off = numbers.point() * (size * width);
    addTriangle(scene, a, b, glm::mix(a, b, numbers.unit()) + off);
  }
  return scene;
}

/// Every triangle of `part` `times` times.
inline Scene copies(Scene part, int times) {
  const std::vector<glm::uvec3> once = part.triangles;
  for (int i = 1; i < times; ++i) part.triangles.insert(part.triangles.end(), once.begin(), once.end());
  return part;
}

/// Overlapping triangles in the walls of a box.
inline Scene coplanar() {
  Scene scene = cube();
  Numbers numbers(3);
  for (int i = 0; i < 300; ++i) {
    glm::dvec3 corners[3];
    for (glm::dvec3& p : corners) {
      p = numbers.point();
      p[i % 3] = i % 2 == 0 ? 1 : -1;
    }
    addTriangle(scene, corners[0], corners[1], corners[2]);
  }
  return scene;
}

/// Points, segments and triangles of no area among others.
inline Scene withDegenerates() {
  Scene scene = soup(200, 0.5, 1, 4);
  for (uint32_t i = 0; i < 200; ++i) {
    const glm::uvec3 t = scene.triangles[i];
    scene.triangles.push_back(i % 3 == 0 ? glm::uvec3(t.x) : (i % 3 == 1 ? glm::uvec3(t.x, t.x, t.y) : t));
    if (i % 3 == 2) scene.triangles.back() = {t.x, t.z, t.z};
  }
  return scene;
}

inline Scene room() {
  testing_support::SceneOfBoxes boxes;
  boxes.addBox({-1, -1, -1}, {1, 1, 1});
  boxes.addBox({-0.25f, -1, -0.25f}, {0.25f, -0.5f, 0.25f});
  boxes.addBox({0.5f, -0.5f, 0.5f}, {0.75f, 0.25f, 0.75f});
  return boxes.finish();
}

/// A wall with a slit of a millionth, a room behind it.
inline Scene slit() {
  testing_support::SceneOfBoxes boxes;
  boxes.addBox({-1, -1, -1}, {1, 1, 1});
  boxes.addRectangle({-1, -1, 0}, {1, 0, 0}, {0, 2, 0});
  boxes.addRectangle({1e-6f, -1, 0}, {1 - 1e-6f, 0, 0}, {0, 2, 0});
  return boxes.finish();
}

inline HardCase place(std::string name, Scene scene, ViewCell cell, double scale = 1, double offset = 0) {
  for (glm::vec3& p : scene.positions) p = glm::vec3(glm::dvec3(p) * scale + offset);
  cell.center = cell.center * scale + offset;
  cell.size *= scale;
  scene.objects = {{"all", 0, uint32_t(scene.triangles.size())}};
  return {std::move(name), std::move(scene), std::move(cell)};
}

inline std::vector<HardCase> hardCases() {
  const ViewCell inside{"inside", {0.1, 0.2, -0.1}, {0.3, 0.2, 0.25}, {0, 0, 0}};
  const ViewCell turned{"turned", {0.1, 0.2, -0.1}, {0.3, 0.2, 0.25}, {20, 30, 40}};
  std::vector<HardCase> cases;
  for (const auto& [what, make] : {std::pair("sphere", &sphere), {"cube", &cube}, {"terrain", &terrain}}) {
    const std::string name(what);
    cases.push_back(place(name, make(), turned));
    cases.push_back(place(name + ", scale 1e-6", make(), turned, 1e-6));
    cases.push_back(place(name + ", scale 1e6", make(), turned, 1e6));
    cases.push_back(place(name + ", scale 1e3 at 1e7", make(), inside, 1e3, 1e7));
  }
  cases.push_back(place("slivers of aspect 1e7", soup(400, 2, 1e-7, 1), turned));
  cases.push_back(place("coincident triangles, 20 of each", copies(soup(40, 1, 1, 2), 20), turned));
  cases.push_back(place("coplanar, overlapping", coplanar(), inside));
  cases.push_back(place("degenerate among others", withDegenerates(), turned));
  cases.push_back(place("cell touches walls", room(), {"touching", {-0.5, 0.5, 0}, {1, 1, 1}, {0, 0, 0}}));
  cases.push_back(
      place("cell contains geometry", room(), {"full", {0.5, 0, 0.5}, {0.5, 0.9, 0.5}, {0, 10, 0}}));
  cases.push_back(place("cell of size 0 in z", room(), {"flat", {0, 0.5, 0.9}, {1, 0.5, 0}, {0, 180, 0}}));
  cases.push_back(place("cell of size 0 in x", room(), {"sheet", {0.1, 0.2, 0}, {0, 0.5, 1}, {0, 0, 0}}));
  cases.push_back(place("cell 2000 times as long as wide", room(),
                        {"long", {0, 0.3, 0}, {0.001, 0.001, 1.9}, {0, 0, 0}}));
  cases.push_back(
      place("slit of a millionth", slit(), {"before", {0.05, 0.1, 0.5}, {0.3, 0.2, 0.3}, {0, 0, 0}}));
  cases.push_back(place("triangles below a float step", soup(400, 1e-4, 1, 5),
                        {"far", {30000, 2, 1}, {1, 1, 1}, {0, 0, 0}}));
  return cases;
}

}  // namespace sightline::hard

// A city: blocks of houses in a grid of streets of various widths, with trees, lamps, cars and wires.
//
//        z                      Streets run between and around the blocks. A block is a pavement raised by
//        ^  | # # # | # # # |   kCityKerb with two rows of lots; houses stand kPavement inside its edge.
//        |  | # # # | # # # |   Free space: within 3.2 m of a street's axis up to 7 m, and the
//        |  +-------+-------+   crossings at any height.
//        |  | # # # | # # # |
//        +------------------> x
#include <algorithm>
#include <cmath>
#include <map>

#include "core/generate/building.h"
#include "core/generate/generator_random.h"
#include "core/generate/rim.h"
#include "core/generate/scene_generators.h"
#include "core/generate/street_props.h"
#include "core/generate/walk_plan.h"

namespace sightline {
namespace {

constexpr float kCityKerb = 0.15f;
constexpr float kPavement = 3.6f;
constexpr float kRoadDepth = 1;  // where it is solid
constexpr uint32_t kLotsAlong = 3;

/// A street's extent across it, and of the blocks behind it, along one axis.
struct Axis {
  std::vector<float> low, high;  // of street 0..n
  uint32_t blocks() const { return uint32_t(low.size()) - 1; }
  float center(uint32_t street) const { return (low[street] + high[street]) / 2; }
  float block_low(uint32_t block) const { return high[block]; }
  float block_high(uint32_t block) const { return low[block + 1]; }
  float start() const { return low.front(); }
  float end() const { return high.back(); }
};

struct CityLayout {
  Axis x, z;  // streets at x.center(i) run along z
};

Axis drawAxis(GeneratorRandom random, uint32_t blocks, float block_size, bool even) {
  Axis axis;
  float at = 0;
  for (uint32_t i = 0; i <= blocks; ++i) {
    const float street = i == blocks / 2 ? 20.0f : random.uniform(13.0f, 17.0f);
    axis.low.push_back(at);
    axis.high.push_back(at + street);
    at += street + block_size * (even ? 1.0f : random.uniform(0.85f, 1.15f));
  }
  const float middle = axis.end() / 2;
  for (float& v : axis.low) v -= middle;
  for (float& v : axis.high) v -= middle;
  return axis;
}

/// even: all blocks are of one size.
CityLayout drawCity(uint64_t triangles, uint64_t seed, bool even = false) {
  // Half of the growth goes into the number of blocks, half into their detail.
  const float blocks = 0.055f * std::sqrt(float(triangles));
  const uint32_t n = std::max(2u, uint32_t(std::sqrt(blocks) + 0.5f));
  return {drawAxis({seed, 0xc17a, 0}, n, 62, even), drawAxis({seed, 0xc17a, 1}, n, 46, even)};
}

std::string numbered(const char* what, uint32_t i, uint32_t j, uint32_t k) {
  return std::string(what) + "-" + std::to_string(i) + "-" + std::to_string(j) + "-" + std::to_string(k);
}

void addRoad(std::vector<ScenePart>& parts, const CityLayout& city) {
  const Axis x = city.x, z = city.z;
  parts.push_back({"road",
                   [x, z](MeshBuilder& mesh, uint32_t level) {
                     const uint32_t n = 2 * x.blocks() * std::max(1u, level);
                     const float margin = 30;
                     const float w = x.end() - x.start() + 2 * margin, d = z.end() - z.start() + 2 * margin;
                     if (mesh.closed()) {
                       closedBlock(mesh, {x.start() - margin, -kRoadDepth, z.start() - margin},
                                   {x.end() + margin, 0, z.end() + margin}, n, n);
                       return;
                     }
                     mesh.patch({x.start() - margin, 0, z.end() + margin}, {w, 0, 0}, {0, 0, -d}, n, n);
                   },
                   16});
}

ScenePart pavement(const std::string& name, glm::vec3 low, glm::vec3 high) {
  return {name,
          [low, high](MeshBuilder& mesh, uint32_t level) {
            const glm::vec3 size = high - low;
            const uint32_t nu = std::max(1u, level * uint32_t(size.x / 8));
            const uint32_t nv = std::max(1u, level * uint32_t(size.z / 8));
            if (mesh.closed()) return closedBlock(mesh, low, high, nu, nv);
            mesh.box(low, high, kNoLowY | kNoHighY);
            mesh.patch({low.x, high.y, high.z}, {size.x, 0, 0}, {0, 0, -size.z}, nu, nv);
          },
          12};
}

void addPavements(std::vector<ScenePart>& parts, const CityLayout& city) {
  const Axis &x = city.x, &z = city.z;
  for (uint32_t i = 0; i < x.blocks(); ++i) {
    for (uint32_t j = 0; j < z.blocks(); ++j) {
      parts.push_back(pavement("pavement-" + std::to_string(i) + "-" + std::to_string(j),
                               {x.block_low(i), 0, z.block_low(j)},
                               {x.block_high(i), kCityKerb, z.block_high(j)}));
    }
  }
}

uint32_t drawFloors(GeneratorRandom& random, float from_center) {
  // Taller towards the middle, with some towers.
  const float tall = 3.0f + 5.0f * (1 - from_center) + random.uniform(-1.5f, 2.5f);
  return uint32_t(std::max(2.0f, random.chance(0.12f) ? tall * 1.8f + 2 : tall));
}

/// A block's extent.
struct BlockPlace {
  float x0, x1, z0, z1;
};

BlockPlace blockAt(const CityLayout& city, uint32_t i, uint32_t j) {
  return {city.x.block_low(i) + kPavement, city.x.block_high(i) - kPavement, city.z.block_low(j) + kPavement,
          city.z.block_high(j) - kPavement};
}

float fromCenter(const CityLayout& city, uint32_t i, uint32_t j) {
  const float n = float(city.x.blocks());
  const float dx = (float(i) + 0.5f) / n - 0.5f, dz = (float(j) + 0.5f) / n - 0.5f;
  return std::min(1.0f, 2 * std::sqrt(dx * dx + dz * dz));
}

/// The houses of block i, j in a place.
void addBlock(std::vector<ScenePart>& parts, const BlockPlace& place, float from_center, uint32_t i,
              uint32_t j, GeneratorRandom random) {
  const auto [x0, x1, z0, z1] = place;
  const float lot = (x1 - x0) / float(kLotsAlong);
  for (uint32_t row = 0; row < 2; ++row) {
    for (uint32_t k = 0; k < kLotsAlong; ++k) {
      BuildingSpec spec;
      const float gap = random.uniform(0.6f, 2.4f), court = random.uniform(2.0f, 4.5f);
      spec.width = lot - (k + 1 < kLotsAlong ? gap : 0);
      spec.depth = (z1 - z0) / 2 - court;
      spec.frame.origin = {x0 + lot * float(k), kCityKerb, row == 0 ? z0 : z1 - spec.depth};
      spec.floors = drawFloors(random, from_center);
      spec.floor_height = random.uniform(3.0f, 3.6f);
      spec.street_sides = row == 0 ? kSideLowZ : kSideHighZ;
      if (k == 0) spec.street_sides |= kSideLowX;
      if (k + 1 == kLotsAlong) spec.street_sides |= kSideHighX;
      spec.seed = random.next();
      parts.push_back({numbered("building", i, j, row * kLotsAlong + k),
                       [spec](MeshBuilder& mesh, uint32_t level) { makeBuilding(mesh, spec, level); },
                       kBuildingLevels});
    }
  }
}

/// Most of the triangles are for houses: what stands in the streets gets fine later.
uint32_t propLevel(uint32_t level) {
  return level < 7 ? (level + 1) / 2 : level - 3;
}

using MakeProp = void (*)(MeshBuilder& mesh, uint64_t seed, uint32_t level);

/// Takes what stands in the streets. street: a part of the names.
class StreetTaker {
 public:
  virtual ~StreetTaker() = default;
  virtual void prop(const char* kind, const std::string& street, const Frame& frame, MakeProp make,
                    uint64_t seed) = 0;
  /// From a to a + across. avenue: wires of the same one have the same `across`.
  virtual void wire(const std::string& street, uint32_t avenue, glm::vec3 a, glm::vec3 across) = 0;
};

/// Each a part of its own.
class StreetParts : public StreetTaker {
 public:
  explicit StreetParts(std::vector<ScenePart>& parts) : parts_(parts) {}

  void prop(const char* kind, const std::string& street, const Frame& frame, MakeProp make,
            uint64_t seed) override {
    parts_.push_back({kind + street + "-" + std::to_string(parts_.size()),
                      [=](MeshBuilder& mesh, uint32_t level) {
                        mesh.frame = frame;
                        make(mesh, seed, propLevel(level));
                      },
                      kPropLevels});
  }
  void wire(const std::string& street, uint32_t, glm::vec3 a, glm::vec3 across) override {
    parts_.push_back(
        {"wire" + street + "-" + std::to_string(parts_.size()),
         [=](MeshBuilder& mesh, uint32_t level) { makeWire(mesh, a, a + across, propLevel(level)); },
         kPropLevels});
  }

 private:
  std::vector<ScenePart>& parts_;
};

/// Modules by what sets them apart.
class CityModules : public StreetTaker {
 public:
  CityModules(RepeatedScene& scene, uint32_t kinds) : scene_(scene), kinds_(kinds) {}

  /// Adds a place of the module, whose parts make() makes, if it is new, in its own frame.
  template <typename Make>
  void place(const std::string& key, const std::string& name, const Frame& frame, Make&& make) {
    const auto [entry, is_new] = made_.emplace(key, scene_.modules.size());
    if (is_new) {
      scene_.modules.emplace_back();
      make(scene_.modules.back().parts);
    }
    scene_.modules[entry->second].places.push_back(
        {name, {vec4(frame.x, 0), vec4(frame.y, 0), vec4(frame.z, 0), vec4(frame.origin, 0)}});
  }

  void prop(const char* kind, const std::string& street, const Frame& frame, MakeProp make,
            uint64_t seed) override {
    const uint64_t variety = seed % kinds_;
    place(kind + std::to_string(variety), kind + street + "-" + std::to_string(count_++), frame,
          [&](std::vector<ScenePart>& parts) {
            parts.push_back(
                {"", [=](MeshBuilder& mesh, uint32_t level) { make(mesh, variety, propLevel(level)); },
                 kPropLevels});
          });
  }
  void wire(const std::string& street, uint32_t avenue, glm::vec3 a, glm::vec3 across) override {
    place("wire" + std::to_string(avenue), "wire" + street + "-" + std::to_string(count_++), Frame{}.at(a),
          [&](std::vector<ScenePart>& parts) {
            parts.push_back(
                {"", [=](MeshBuilder& mesh, uint32_t level) { makeWire(mesh, {}, across, propLevel(level)); },
                 kPropLevels});
          });
  }

 private:
  RepeatedScene& scene_;
  const uint32_t kinds_;
  uint64_t count_ = 0;  ///< names are different
  std::map<std::string, size_t> made_;
};

/// One side of a street along a block: its frame stands on the kerb's edge, x points to the street's axis.
void addStreetSide(StreetTaker& street, const Frame& kerb, float length, const std::string& name,
                   GeneratorRandom random) {
  const auto add = [&](const char* kind, const Frame& frame, MakeProp make) {
    street.prop(kind, name, frame, make, random.next());
  };
  const float slot = 6.5f;
  for (float at = 4; at + 4 < length; at += slot) {
    const float kind = random.unit();
    const Frame pavement = kerb.at({-0.9f, kCityKerb, at});
    if (kind < 0.45f) {
      add("tree", pavement, makeTree);
    } else if (kind < 0.75f) {
      add("lamp", pavement, makeLamp);
    } else if (kind < 0.9f) {
      add("bin", pavement, makeBin);
    }
    if (random.chance(0.6f)) {
      const float turned = random.chance(0.5f) ? 0.0f : 0.5f;
      add("car", kerb.at({1.25f, 0, at + random.uniform(-0.4f, 0.4f)}, turned), makeCar);
    }
  }
}

void addWires(StreetTaker& street, uint32_t avenue, glm::vec3 start, glm::vec3 along, glm::vec3 across,
              float length, const std::string& name, GeneratorRandom random) {
  for (float at = 12; at + 8 < length; at += 24) {
    street.wire(name, avenue, start + along * at + glm::vec3(0, random.uniform(8.5f, 9.5f), 0), across);
  }
}

void addStreets(StreetTaker& street, const CityLayout& city, uint64_t seed) {
  const float reach = kPavement - 0.01f;  // wires go from wall to wall
  for (uint32_t i = 0; i <= city.x.blocks(); ++i) {
    for (uint32_t j = 0; j < city.z.blocks(); ++j) {
      const std::string name = "-north-" + std::to_string(i) + "-" + std::to_string(j);
      const float z0 = city.z.block_low(j), z1 = city.z.block_high(j);
      const float x0 = city.x.low[i], x1 = city.x.high[i];
      const uint64_t tag = uint64_t(i) * 65536 + j;
      if (i > 0) {
        addStreetSide(street, Frame{}.at({x0, 0, z0}), z1 - z0, name, {seed, 0x51de0, tag});
      }
      if (i < city.x.blocks()) {
        addStreetSide(street, Frame{}.at({x1, 0, z1}, 0.5f), z1 - z0, name, {seed, 0x51de1, tag});
      }
      if (i > 0 && i < city.x.blocks()) {
        addWires(street, i, {x0 - reach, 0, z0}, {0, 0, 1}, {x1 - x0 + 2 * reach, 0, 0}, z1 - z0, name,
                 {seed, 0x3172, tag});
      }
    }
  }
  for (uint32_t j = 0; j <= city.z.blocks(); ++j) {
    for (uint32_t i = 0; i < city.x.blocks(); ++i) {
      const std::string name = "-east-" + std::to_string(i) + "-" + std::to_string(j);
      const float x0 = city.x.block_low(i), x1 = city.x.block_high(i);
      const uint64_t tag = uint64_t(i) * 65536 + j;
      if (j > 0) {
        addStreetSide(street, Frame{}.at({x1, 0, city.z.low[j]}, -0.25f), x1 - x0, name,
                      {seed, 0x51de2, tag});
      }
      if (j < city.z.blocks()) {
        addStreetSide(street, Frame{}.at({x0, 0, city.z.high[j]}, 0.25f), x1 - x0, name,
                      {seed, 0x51de3, tag});
      }
    }
  }
}

}  // namespace

std::vector<ScenePart> cityParts(uint64_t triangles, uint64_t seed) {
  const CityLayout city = drawCity(triangles, seed);
  std::vector<ScenePart> parts;
  addRoad(parts, city);
  addPavements(parts, city);
  for (uint32_t i = 0; i < city.x.blocks(); ++i) {
    for (uint32_t j = 0; j < city.z.blocks(); ++j) {
      addBlock(parts, blockAt(city, i, j), fromCenter(city, i, j), i, j,
               {seed, 0xb10c, uint64_t(i) * 65536 + j});
    }
  }
  StreetParts streets(parts);
  addStreets(streets, city, seed);
  return parts;
}

RepeatedScene repeatedCity(uint64_t triangles, uint64_t seed, uint32_t kinds) {
  const CityLayout city = drawCity(triangles, seed, true);
  RepeatedScene scene;
  addRoad(scene.parts, city);
  CityModules modules(scene, kinds);
  addStreets(modules, city, seed);
  const BlockPlace first = blockAt(city, 0, 0);
  const BlockPlace local = {0, first.x1 - first.x0, 0, first.z1 - first.z0};
  const glm::vec3 high(local.x1 + 2 * kPavement, kCityKerb, local.z1 + 2 * kPavement);
  for (uint32_t i = 0; i < city.x.blocks(); ++i) {
    for (uint32_t j = 0; j < city.z.blocks(); ++j) {
      const uint32_t kind = GeneratorRandom(seed, 0x71d5, uint64_t(i) * 65536 + j).below(kinds);
      const BlockPlace at = blockAt(city, i, j);
      const std::string name = std::to_string(i) + "-" + std::to_string(j);
      modules.place("pavement", "pavement-" + name, Frame{}.at({at.x0 - kPavement, 0, at.z0 - kPavement}),
                    [&](std::vector<ScenePart>& parts) { parts.push_back(pavement("", {}, high)); });
      modules.place(
          "block" + std::to_string(kind), "block-" + name, Frame{}.at({at.x0, 0, at.z0}),
          [&](std::vector<ScenePart>& parts) {
            addBlock(parts, local, GeneratorRandom(seed, 0x71d6, kind).unit(), 0, 0, {seed, 0xb10c, kind});
          });
    }
  }
  return scene;
}

std::vector<ViewCell> cityCells(uint64_t triangles, uint64_t seed, bool even) {
  const CityLayout city = drawCity(triangles, seed, even);
  const uint32_t n = city.x.blocks(), m = n / 2;
  const double x = city.x.center(m), z = city.z.center(m);  // the crossing of the two avenues
  const double x_length = city.x.end() - city.x.start(), z_length = city.z.end() - city.z.start();
  const double first_z = (city.z.block_low(0) + city.z.block_high(0)) / 2;
  const double last_z = (city.z.block_low(n - 1) + city.z.block_high(n - 1)) / 2;
  const double first_x = (city.x.block_low(0) + city.x.block_high(0)) / 2;
  const double side_z = city.z.center(n - 1);
  return {
      {"flat-1", {x, 2.3, first_z}, {5, 4, 0}, {0, 0, 0}},
      {"flat-2", {x, 2.3, last_z}, {5, 4, 0}, {0, 180, 0}},
      {"flat-3", {first_x, 2.3, z}, {5, 4, 0}, {0, 98, 0}},
      {"flat-4", {x, 16, z}, {10, 4, 0}, {20, 38, 0}},
      {"box-1", {x, 1.7, (first_z + z) / 2}, {4, 3, 6}, {0, 0, 0}},
      {"box-2", {x, 14, z}, {8, 6, 8}, {0, 10, 0}},
      {"box-3", {double(city.x.center(0)), 1.6, side_z}, {1, 1, 1}, {0, 45, 0}},
      {"street-1", {x, 1.5, 0}, {2.5, 2, std::min(150.0, z_length * 0.8)}, {0, 0, 0}},
      {"street-2", {0, 1.5, z}, {2.5, 2, std::min(150.0, x_length * 0.8)}, {0, 90, 0}},
      {"street-3",
       {double(city.x.center(n - 1)), 1.5, 0},
       {2.5, 2, std::min(600.0, z_length * 0.9)},
       {0, 0, 0}},
  };
}

CameraPath cityWalk(uint64_t triangles, uint64_t seed, uint32_t frames, bool even) {
  const CityLayout city = drawCity(triangles, seed, even);
  constexpr double kEye = 1.7, kAboveRoofs = 110;
  const uint32_t n = city.x.blocks();
  const double x = city.x.center(n / 2), z = city.z.center(n / 2), side_x = city.x.center(n - 1);
  const double z0 = city.z.block_low(0), z1 = city.z.block_high(n - 1), x1 = city.x.block_high(n - 1);
  const double extent = std::max(city.x.end() - city.x.start(), city.z.end() - city.z.start()) + 60;
  WalkPlan plan(frames);
  plan.key(0, {x, kEye, z0}, {x, kEye, z0 + 10});
  plan.turn(kTurnFrom, kTurnTo, {x, kEye, z}, 0, -270);
  plan.key(kSecondTo, {x1, kEye, z}, {x1 + 10, kEye, z});
  plan.cut(kSideFrom, {side_x, kEye, z1}, {side_x, kEye, z1 - 10});
  plan.key(kSideTo, {side_x, kEye, z0}, {side_x, kEye, z0 - 10});
  plan.cut(kRiseFrom, {x, kEye, z}, {x, kEye, z - 20});
  plan.key(0.78, {x, kAboveRoofs / 2, z}, {x, kAboveRoofs / 4, z - 40});
  plan.key(0.84, {x, kAboveRoofs, z}, {x, kAboveRoofs / 2, z - 60});
  plan.key(0.86, {x, kAboveRoofs * 1.2, z}, {x, kAboveRoofs / 2, z - 60});
  plan.seeAll({(city.x.start() + city.x.end()) / 2, 0, (city.z.start() + city.z.end()) / 2}, extent,
              {0, 0, 1});
  return plan.path();
}

}  // namespace sightline

// A street of cafes: houses on both sides, before each a terrace of tables, chairs, cups, bottles, lamps and
// potted plants; parasols, strings of lights above, and balls of thin fibres on plinths.
//
//     x ^  houses ##### ##### #####    facade at kFacade
//       |  terraces  o  o   o  o       from kBistroKerb
//       |  street ------------------> z, free space for cells: |x| < 2.6 m up to kBistroFreeHeight
//       |  terraces  o  o   o  o
//          houses ##### ##### #####    and one across each end
#include <algorithm>
#include <cmath>

#include "core/generate/bistro_props.h"
#include "core/generate/building.h"
#include "core/generate/generator_random.h"
#include "core/generate/scene_generators.h"
#include "core/generate/street_props.h"
#include "core/generate/walk_plan.h"

namespace sightline {
namespace {

constexpr float kBistroFreeHeight = 4.8f;
constexpr float kBistroKerb = 3.0f, kKerbHeight = 0.12f, kFacade = 7.2f;
constexpr float kLot = 12, kHouseDepth = 10;
constexpr float kEnd = 4;  // from the last lot to the house across the end
constexpr uint32_t kHairballStrands = 60;

struct BistroLayout {
  uint32_t lots;  // on each side
  uint64_t seed;
  float length() const { return kLot * float(lots); }
  float lotStart(uint32_t lot) const { return kLot * float(lot) - length() / 2; }
};

BistroLayout drawBistro(uint64_t triangles, uint64_t seed) {
  return {std::max(2u, uint32_t(0.01f * std::sqrt(float(triangles)) + 0.5f)), seed};
}

/// Collects parts that stand in a frame, named kind-NUMBER.
class BistroBuilder {
 public:
  explicit BistroBuilder(const BistroLayout& street) : street_(street) {}
  std::vector<ScenePart> build();

 private:
  template <class Make>
  void add(const char* kind, const Frame& frame, Make make) {
    parts_.push_back({std::string(kind) + "-" + std::to_string(parts_.size()),
                      [frame, make](MeshBuilder& mesh, uint32_t level) {
                        mesh.frame = frame;
                        make(mesh, level);
                      },
                      kBistroLevels});
  }
  void addGround();
  void addHouse(const Frame& corner, float width, uint32_t sides, GeneratorRandom& random);
  void addSet(const Frame& at, GeneratorRandom& random);
  void addTerrace(const Frame& lot, GeneratorRandom& random);
  void addHairball(const Frame& at, GeneratorRandom& random);
  void addLights(uint32_t lot, GeneratorRandom& random);

  BistroLayout street_;
  std::vector<ScenePart> parts_;
};

void BistroBuilder::addGround() {
  const float half = street_.length() / 2 + kEnd, reach = half + kHouseDepth + 5,
              side = kFacade + kHouseDepth + 5;
  add("street", Frame{}, [=](MeshBuilder& mesh, uint32_t level) {
    const uint32_t n = 1 + std::min(200u, level * level);
    mesh.patch({-side, 0, reach}, {2 * side, 0, 0}, {0, 0, -2 * reach}, 1 + n / 4, n);
  });
  for (const float s : {-1.0f, 1.0f}) {
    const float x0 = s < 0 ? -kFacade : kBistroKerb, x1 = s < 0 ? -kBistroKerb : kFacade;
    add("pavement", Frame{}, [=](MeshBuilder& mesh, uint32_t level) {
      mesh.box({x0, 0, -half}, {x1, kKerbHeight, half}, kNoLowY | kNoHighY);
      const uint32_t along = 1 + level * uint32_t(half / 4), across = 1 + level;
      mesh.patch({x0, kKerbHeight, half}, {x1 - x0, 0, 0}, {0, 0, -2 * half}, across, along);
    });
  }
}

void BistroBuilder::addHouse(const Frame& corner, float width, uint32_t sides, GeneratorRandom& random) {
  BuildingSpec spec;
  spec.frame = corner;
  spec.width = width;
  spec.depth = kHouseDepth;
  spec.floors = 3 + random.below(3);
  spec.floor_height = random.uniform(3.1f, 3.6f);
  spec.street_sides = sides;
  spec.seed = random.next();
  parts_.push_back({"house-" + std::to_string(parts_.size()),
                    [spec](MeshBuilder& mesh, uint32_t level) { makeBuilding(mesh, spec, level); },
                    kBuildingLevels});
}

/// A table with what is on it and around it.
void BistroBuilder::addSet(const Frame& at, GeneratorRandom& random) {
  add("table", at, makeTable);
  const uint32_t chairs = 2 + random.below(3);
  const float turned = random.unit();
  for (uint32_t i = 0; i < chairs; ++i) {
    const float angle = turned + float(i) / float(chairs) + random.uniform(-0.03f, 0.03f);
    const Turn t = turn(angle);
    // The chair's +z looks at the table.
    add("chair", at.at({-t.sin * 0.62f, 0, -t.cos * 0.62f}, angle), makeChair);
    if (!random.chance(0.7f)) continue;
    add("cup", at.at({-t.sin * 0.24f, kTableHeight, -t.cos * 0.24f}, random.unit()), makeCup);
  }
  const Turn t = turn(turned + 0.5f / float(chairs));
  const Frame middle = at.at({t.sin * 0.08f, kTableHeight, t.cos * 0.08f}, random.unit());
  if (random.chance(0.5f)) {
    add("bottle", middle, makeBottle);
  } else {
    add("table-lamp", middle, makeTableLamp);
  }
}

void BistroBuilder::addHairball(const Frame& at, GeneratorRandom& random) {
  add("plinth", at, [](MeshBuilder& mesh, uint32_t level) {
    if (level > 1) mesh.box({-0.4f, 0, -0.4f}, {0.4f, 0.5f, 0.4f}, kNoLowY);
  });
  for (uint32_t i = 0; i < kHairballStrands; ++i) {
    const uint64_t own = random.next();
    add("hairball", at.at({0, 0.5f, 0}),
        [=](MeshBuilder& mesh, uint32_t level) { makeHairballStrand(mesh, 1.1f, own, level); });
  }
}

/// Terrace of a lot: x of the frame leads from the kerb to the facade, z along the street.
void BistroBuilder::addTerrace(const Frame& lot, GeneratorRandom& random) {
  const auto withSeed = [&](const char* kind, const Frame& frame, auto make) {
    const uint64_t own = random.next();
    add(kind, frame, [=](MeshBuilder& mesh, uint32_t level) { make(mesh, own, level); });
  };
  for (const float z : {0.6f, kLot - 0.6f}) withSeed("plant", lot.at({2.9f, 0, z}), makePottedPlant);
  if (random.chance(0.5f)) withSeed("plant", lot.at({0.85f, 0, kLot - 0.8f}), makePottedPlant);
  withSeed("lamp", lot.at({0.35f, 0, 0.3f}, 0.5f), makeLamp);
  if (random.chance(0.4f)) withSeed("bin", lot.at({0.4f, 0, kLot / 2}), makeBin);
  const uint32_t sets = 3 + random.below(2);
  for (uint32_t i = 0; i < sets; ++i) {
    const float z = 1.6f + (kLot - 3) * (float(i) + 0.5f) / float(sets);
    const Frame at = lot.at({random.uniform(1.5f, 1.9f), 0, z});
    addSet(at, random);
    if (i % 2 == 1) add("parasol", at.at({0.95f, 0, 0}), makeParasol);
  }
}

void BistroBuilder::addLights(uint32_t lot, GeneratorRandom& random) {
  for (const float share : {0.3f, 0.8f}) {
    const float z = street_.lotStart(lot) + kLot * share, y = kBistroFreeHeight + random.uniform(0.8f, 1.4f);
    const float slant = random.uniform(-3, 3);
    add("lights", Frame{}, [=](MeshBuilder& mesh, uint32_t level) {
      makeStringLights(mesh, {-kFacade + 0.01f, y, z}, {kFacade - 0.01f, y, z + slant}, level);
    });
  }
}

std::vector<ScenePart> BistroBuilder::build() {
  addGround();
  GeneratorRandom random(street_.seed, 0xb157);
  for (uint32_t lot = 0; lot < street_.lots; ++lot) {
    const float z0 = street_.lotStart(lot), z1 = z0 + kLot;
    const float gap = random.chance(0.3f) ? random.uniform(0.8f, 2) : 0.02f;
    const bool hairball = lot % 8 == street_.lots / 2 % 8;
    // Houses: local x along the street, so that their high z is the facade.
    addHouse(Frame{}.at({-kFacade - kHouseDepth, kKerbHeight, z1 - gap}, 0.25f), kLot - gap, kSideHighZ,
             random);
    addHouse(Frame{}.at({kFacade + kHouseDepth, kKerbHeight, z0}, -0.25f), kLot - gap, kSideHighZ, random);
    const Frame left = Frame{}.at({-kBistroKerb, kKerbHeight, z1}, 0.5f),
                right = Frame{}.at({kBistroKerb, kKerbHeight, z0});
    addTerrace(left, random);
    if (hairball) {
      addHairball(right.at({1.7f, 0, kLot / 2}), random);
    } else {
      addTerrace(right, random);
    }
    addLights(lot, random);
  }
  const float end = street_.length() / 2 + kEnd, half = kFacade + kHouseDepth;
  addHouse(Frame{}.at({-half, 0, -end - kHouseDepth}), 2 * half, kSideHighZ, random);
  addHouse(Frame{}.at({half, 0, end + kHouseDepth}, 0.5f), 2 * half, kSideHighZ, random);
  return std::move(parts_);
}

}  // namespace

std::vector<ScenePart> bistroParts(uint64_t triangles, uint64_t seed) {
  return BistroBuilder(drawBistro(triangles, seed)).build();
}

std::vector<ViewCell> bistroCells(uint64_t triangles, uint64_t seed) {
  const BistroLayout street = drawBistro(triangles, seed);
  const double length = street.length(), half = length / 2;
  const double long_one = std::min(150.0, length - 2);
  return {
      {"flat-1", {0, 1.7, -half + 0.5}, {3, 2, 0}, {0, 0, 0}},
      {"flat-2", {0, 2.2, half - 0.5}, {5, 4, 0}, {0, 180, 0}},
      {"flat-3", {2, 1.5, length * 0.1}, {1, 1, 0}, {0, 90, 0}},
      {"flat-4", {0, 32, -half * 0.5}, {6, 6, 0}, {50, 20, 0}},
      {"box-1", {0, 1.6, length * 0.2}, {2, 2, 2}, {0, 0, 0}},
      {"box-2", {0, 2, -length * 0.15}, {3, 2.5, 4}, {0, 12, 0}},
      {"box-3", {-1.8, 1.5, 0}, {0.6, 0.6, 0.6}, {0, 45, 0}},
      {"street-1", {0, 1.5, 0}, {2.5, 2, long_one}, {0, 0, 0}},
      {"street-2", {1.6, 1.6, 0}, {1, 1, long_one / 2}, {0, 0, 0}},
      {"street-3", {-1, 1.5, length * 0.2}, {1.2, 2, long_one / 3}, {0, 0, 0}},
  };
}

CameraPath bistroWalk(uint64_t triangles, uint64_t seed, uint32_t frames) {
  const BistroLayout street = drawBistro(triangles, seed);
  constexpr double kEye = 1.6, kAboveRoofs = 32, kNearFacades = 1.8;
  const double half = street.length() / 2, end = half - 0.5, first = -0.4 * half, last = 0.6 * half;
  const double extent = 2 * (half + kEnd + kHouseDepth + 5);
  WalkPlan plan(frames);
  plan.key(0, {0, kEye, -end}, {0, kEye, -end + 10});
  plan.turn(kTurnFrom, kTurnTo, {0, kEye, first}, 0, -360);
  plan.key(0.3, {kNearFacades, kEye, first + 0.2 * (last - first)}, {10, kEye, first + 0.4 * (last - first)});
  plan.key(kSecondTo, {kNearFacades, kEye, last}, {11, kEye, last + 1});
  plan.cut(kSideFrom, {0, kEye, end}, {0, kEye, end - 10});
  plan.key(kSideTo, {0, kEye, 0}, {0, kEye, -10});
  plan.cut(kRiseFrom, {0, kAboveRoofs, -half / 2}, {0, kAboveRoofs / 2, 10 - half / 2});
  plan.seeAll({0, 0, 0}, extent, {0, 0, -1});
  return plan.path();
}

}  // namespace sightline

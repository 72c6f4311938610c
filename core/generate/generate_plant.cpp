// A process plant: storeys of bays full of machines and pipes, with aisles between the bays.
//
//      z ^   +----+  +----+       A bay is kBay wide and has steel columns at its corners, beams and a floor
//        |   |bay |  |bay |       of gratings above. Free space for cells: in the aisles, kFreeAisle to both
//        |   +----+  +----+       sides of their middle and up to kPlantFreeHeight above the floor; pipe
//        racks and |     aisle  kAisle      cable trays run above that. Storage tanks stand beyond the
//        highest x. |   +----+  +----+
//        +------------------> x
#include <algorithm>
#include <cmath>
#include <map>

#include "core/generate/plant_pipes.h"
#include "core/generate/plant_units.h"
#include "core/generate/scene_generators.h"
#include "core/generate/walk_plan.h"

namespace sightline {
namespace {

constexpr float kBay = 14, kAisle = 4, kPitch = kBay + kAisle, kStorey = 6;
constexpr float kPlantFreeHeight = 3.2f;
constexpr float kMargin = 18;   // of the ground around the bays
constexpr float kClear = 5.2f;  // height for machines and pipes
constexpr uint32_t kPipesInBay = 40;

struct PlantLayout {
  uint32_t nx, nz, storeys;
  uint64_t seed;

  float width() const { return kPitch * float(nx) - kAisle; }
  float depth() const { return kPitch * float(nz) - kAisle; }
  /// Middle of the aisle after bay i.
  static double aisle(uint32_t i) { return double(kPitch) * i + kBay + kAisle / 2; }
};

PlantLayout drawPlant(uint64_t triangles, uint64_t seed) {
  // Bays in all storeys grow with the square root of the count; so does what is in each.
  const float root = std::sqrt(float(triangles));
  const uint32_t storeys = triangles < 20'000 ? 1 : triangles < 400'000 ? 2 : triangles < 8'000'000 ? 3 : 4;
  const float side = std::sqrt(0.12f * root / float(storeys));
  return {std::max(2u, uint32_t(side * 1.15f + 0.5f)), std::max(2u, uint32_t(side * 0.9f + 0.5f)), storeys,
          seed};
}

/// Collects parts whose builder starts in a frame, named kind-I-J-STOREY-NUMBER.
class PlantBuilder {
 public:
  explicit PlantBuilder(const PlantLayout& plant) : plant_(plant) {}
  std::vector<ScenePart> build();
  RepeatedScene buildRepeated(uint32_t kinds);

 private:
  template <class Make>
  void add(const std::string& name, const Frame& frame, Make make) {
    parts_.push_back({name + "-" + std::to_string(parts_.size()),
                      [frame, make](MeshBuilder& mesh, uint32_t level) {
                        mesh.frame = frame;
                        make(mesh, level);
                      },
                      kUnitLevels});
  }
  void addGround();
  void addSteel(const Frame& bay, const std::string& name, bool floor_above);
  PipeBox addMachines(const Frame& bay, const std::string& name, GeneratorRandom& random);
  void addPipes(const Frame& bay, const std::string& name, const PipeBox& obstacle, GeneratorRandom& random);
  void addRack(const Frame& middle, float low, float length, const std::string& name,
               GeneratorRandom& random);
  struct Aisles {
    bool x, z, floor;  ///< at high x, at high z; with a walkway
  };
  Aisles aislesOf(uint32_t i, uint32_t j, uint32_t storey) const {
    return {i + 1 < plant_.nx, j + 1 < plant_.nz, storey > 0};
  }
  void addAisles(const Frame& bay, Aisles aisles, const std::string& name, GeneratorRandom random);
  void addStorageTanks();

  PlantLayout plant_;
  std::vector<ScenePart> parts_;
};

void PlantBuilder::addGround() {
  const float x0 = -kMargin, w = plant_.width() + kMargin + 40, d = plant_.depth() + 2 * kMargin;
  add("ground", Frame{}, [=](MeshBuilder& mesh, uint32_t level) {
    const uint32_t n = 1 + std::min(60u, level * level);
    mesh.patch({x0, 0, d - kMargin}, {w, 0, 0}, {0, 0, -d}, n, n);
  });
}

void PlantBuilder::addSteel(const Frame& bay, const std::string& name, bool floor_above) {
  const float size = 0.34f, e = size / 2 + 0.02f, top = kStorey - 0.08f;
  for (const float x : {e, kBay - e}) {
    for (const float z : {e, kBay - e}) {
      // Upright: local z goes up.
      Frame column = bay.at({x, 0, z});
      column = {column.origin, column.x, -column.z, column.y};
      add("column-" + name, column,
          [=](MeshBuilder& mesh, uint32_t level) { makeBeam(mesh, top - size, size, level); });
    }
  }
  const float y = top - size / 2 - 0.01f, length = kBay - 2 * size - 0.06f;
  for (const float a : {e, kBay - e}) {
    add("beam-" + name, bay.at({a, y, size + 0.03f}),
        [=](MeshBuilder& mesh, uint32_t level) { makeBeam(mesh, length, size * 0.9f, level); });
    add("beam-" + name, bay.at({size + 0.03f, y, a}, 0.25f),
        [=](MeshBuilder& mesh, uint32_t level) { makeBeam(mesh, length, size * 0.9f, level); });
  }
  if (!floor_above) return;
  add("grating-" + name, bay.at({0, kStorey, 0}),
      [](MeshBuilder& mesh, uint32_t level) { makeGrating(mesh, kBay, kBay, level); });
  for (const float z : {0.06f, kBay - 0.06f}) {
    add("railing-" + name, bay.at({0.4f, kStorey, z}),
        [](MeshBuilder& mesh, uint32_t level) { makeRailing(mesh, kBay - 0.8f, level); });
  }
}

PipeBox PlantBuilder::addMachines(const Frame& bay, const std::string& name, GeneratorRandom& random) {
  const uint64_t own = random.next();
  switch (random.below(5)) {
    case 0: {
      const float radius = random.uniform(2.0f, 3.4f), height = random.uniform(4.4f, 5.1f);
      add("tank-" + name, bay.at({7, 0, 7}, random.unit()),
          [=](MeshBuilder& mesh, uint32_t level) { makeTank(mesh, radius, height, own, level); });
      return {{7 - radius, 0, 7 - radius}, {7 + radius, height, 7 + radius}};
    }
    case 1: {
      const float radius = random.uniform(0.9f, 1.3f);
      for (const float z : {4.5f, 9.5f}) {
        add("drum-" + name, bay.at({7, 0, z}),
            [=](MeshBuilder& mesh, uint32_t level) { makeDrum(mesh, radius, 8.5f, level); });
      }
      return {{2.7f, 0, 4.5f - radius}, {11.3f, 2 * radius + 0.9f, 9.5f + radius}};
    }
    case 2: {
      const float deep = random.uniform(2, 4), high = random.uniform(2.4f, 4);
      const glm::vec3 size(9, high, deep);
      add("exchanger-" + name, bay.at({2.5f, 0, 7 - size.z / 2}),
          [=](MeshBuilder& mesh, uint32_t level) { makeTubeBank(mesh, size, level); });
      return {{2.5f, 0, 7 - size.z / 2}, {11.5f, size.y, 7 + size.z / 2}};
    }
    case 3:
      add("stair-" + name, bay.at({1, 0, 3}),
          [](MeshBuilder& mesh, uint32_t level) { makeStair(mesh, 1.1f, 7.5f, kStorey - 0.1f, level); });
      return {{1, 0, 3}, {2.1f, kStorey, 10.5f}};
    default:
      for (uint32_t k = 0; k < 4; ++k) {
        add("pump-" + name, bay.at({6, 0, 2.5f + 3 * float(k)}), makePump);
      }
      return {{5, 0, 2}, {7, 1.4f, 12}};
  }
}

void PlantBuilder::addPipes(const Frame& bay, const std::string& name, const PipeBox& obstacle,
                            GeneratorRandom& random) {
  const PipeBox room{{0.5f, 0.15f, 0.5f}, {kBay - 0.5f, kClear, kBay - 0.5f}};
  for (uint32_t k = 0; k < kPipesInBay; ++k) {
    const float radius = random.chance(0.7f) ? random.uniform(0.03f, 0.08f) : random.uniform(0.1f, 0.24f);
    const std::vector<glm::vec3> corners = routePipe(random, room, obstacle, radius, 2 + random.below(8));
    const uint32_t late = random.below(5);  // not all turn up at the same level
    add("pipe-" + name, bay, [=](MeshBuilder& mesh, uint32_t level) {
      makePipe(mesh, corners, radius, level > late ? level - late : 0);
    });
    if (!random.chance(0.35f)) continue;
    // On a level leg, its frame's x along the pipe.
    for (size_t i = 0; i + 1 < corners.size(); ++i) {
      const glm::vec3 leg = corners[i + 1] - corners[i];
      const float length = std::fabs(leg.x) + std::fabs(leg.z);
      if (leg.y != 0 || length < 8 * radius) continue;
      add("valve-" + name, bay.at(corners[i] + leg * 0.3f, leg.x != 0 ? 0.0f : 0.25f),
          [=](MeshBuilder& mesh, uint32_t level) {
            makeValve(mesh, radius, level > late ? level - late : 0);
          });
      break;
    }
  }
}

/// Straight pipes and a cable tray above an aisle, along z of the frame.
void PlantBuilder::addRack(const Frame& middle, float low, float length, const std::string& name,
                           GeneratorRandom& random) {
  for (float x = -1.7f; x < 0.9f;) {
    const float radius = random.uniform(0.04f, 0.17f);
    const std::vector<glm::vec3> line{{x + radius, low + 1.6f * radius, 0.02f},
                                      {x + radius, low + 1.6f * radius, length - 0.02f}};
    add("rack-" + name, middle,
        [=](MeshBuilder& mesh, uint32_t level) { makePipe(mesh, line, radius, level); });
    x += 3.3f * radius + 0.05f;
  }
  add("tray-" + name, middle.at({1.5f, low, 0}),
      [=](MeshBuilder& mesh, uint32_t level) { makeCableTray(mesh, length, level); });
}

/// The aisles at high x and high z of a bay, with their crossing.
void PlantBuilder::addAisles(const Frame& bay, Aisles aisles, const std::string& name,
                             GeneratorRandom random) {
  const glm::vec3 corner = bay.origin;
  const auto floor = [&](glm::vec3 low, float width, float depth) {
    if (!aisles.floor) return;
    add("walkway-" + name, Frame{}.at(low),
        [=](MeshBuilder& mesh, uint32_t level) { makeGrating(mesh, width, depth, level); });
  };
  if (aisles.x) {
    floor(corner + glm::vec3(kBay, 0, 0), kAisle, kBay);
    addRack(Frame{}.at(corner + glm::vec3(kBay + kAisle / 2, 0, 0)), kPlantFreeHeight + 0.2f, kPitch, name,
            random);
  }
  if (aisles.z) {
    floor(corner + glm::vec3(0, 0, kBay), kBay, kAisle);
    addRack(Frame{}.at(corner + glm::vec3(0, 0, kBay + kAisle / 2), 0.25f), kPlantFreeHeight + 1.1f, kPitch,
            name, random);
  }
  if (aisles.x && aisles.z) floor(corner + glm::vec3(kBay, 0, kBay), kAisle, kAisle);
}

void PlantBuilder::addStorageTanks() {
  for (float z = 7; z + 7 < plant_.depth() + kAisle; z += kPitch) {
    GeneratorRandom random(plant_.seed, 0x57021, parts_.size());
    const float radius = random.uniform(4.5f, 7), height = random.uniform(7, 14);
    const uint64_t own = random.next();
    add("storage", Frame{}.at({plant_.width() + 20, 0, z}, random.unit()),
        [=](MeshBuilder& mesh, uint32_t level) { makeTank(mesh, radius, height, own, level); });
  }
}

std::vector<ScenePart> PlantBuilder::build() {
  addGround();
  for (uint32_t storey = 0; storey < plant_.storeys; ++storey) {
    for (uint32_t i = 0; i < plant_.nx; ++i) {
      for (uint32_t j = 0; j < plant_.nz; ++j) {
        const uint64_t index = (uint64_t(storey) * 4096 + i) * 4096 + j;
        GeneratorRandom random(plant_.seed, 0xba4, index);
        const std::string name = std::to_string(i) + "-" + std::to_string(j) + "-" + std::to_string(storey);
        const Frame bay = Frame{}.at({kPitch * float(i), kStorey * float(storey), kPitch * float(j)});
        addSteel(bay, name, storey + 1 < plant_.storeys);
        const PipeBox obstacle = addMachines(bay, name, random);
        addPipes(bay, name, obstacle, random);
        addAisles(bay, aislesOf(i, j, storey), name, {plant_.seed, 0xa151e, index});
      }
    }
  }
  addStorageTanks();
  return std::move(parts_);
}

/// Every other bay along x is mirrored about its middle.
RepeatedScene PlantBuilder::buildRepeated(uint32_t kinds) {
  RepeatedScene scene;
  addGround();
  addStorageTanks();
  scene.parts = std::move(parts_);
  std::map<std::vector<uint32_t>, size_t> made;  // modules by what sets them apart
  const auto module = [&](const std::vector<uint32_t>& key, auto&& make) -> SceneModule& {
    const auto [entry, is_new] = made.emplace(key, scene.modules.size());
    if (is_new) {
      parts_.clear();
      make();
      scene.modules.push_back({std::move(parts_), {}});
    }
    return scene.modules[entry->second];
  };
  for (uint32_t storey = 0; storey < plant_.storeys; ++storey) {
    for (uint32_t i = 0; i < plant_.nx; ++i) {
      for (uint32_t j = 0; j < plant_.nz; ++j) {
        const uint64_t index = (uint64_t(storey) * 4096 + i) * 4096 + j;
        const uint32_t kind = GeneratorRandom(plant_.seed, 0x71d5, index).below(kinds);
        const bool roofed = storey + 1 < plant_.storeys;
        const std::string name = std::to_string(i) + "-" + std::to_string(j) + "-" + std::to_string(storey);
        const glm::vec3 corner(kPitch * float(i), kStorey * float(storey), kPitch * float(j));
        SceneModule& bay = module({0, kind, roofed}, [&] {
          GeneratorRandom random(plant_.seed, 0xba4, kind);
          addSteel({}, "", roofed);
          addPipes({}, "", addMachines({}, "", random), random);
        });
        const bool mirrored = i % 2 == 1;
        bay.places.push_back({"bay-" + name,
                              {vec4(mirrored ? -1 : 1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0),
                               vec4(corner + glm::vec3(mirrored ? kBay : 0, 0, 0), 0)}});
        const Aisles aisles = aislesOf(i, j, storey);
        if (!aisles.x && !aisles.z) continue;
        SceneModule& aisle = module({1, kind, aisles.x, aisles.z, aisles.floor}, [&] {
          addAisles({}, aisles, "", {plant_.seed, 0xa151e, kind});
        });
        aisle.places.push_back(
            {"aisles-" + name, {vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0), vec4(corner, 0)}});
      }
    }
  }
  return scene;
}

}  // namespace

RepeatedScene repeatedPlant(uint64_t triangles, uint64_t seed, uint32_t kinds) {
  return PlantBuilder(drawPlant(triangles, seed)).buildRepeated(kinds);
}

std::vector<ScenePart> plantParts(uint64_t triangles, uint64_t seed) {
  return PlantBuilder(drawPlant(triangles, seed)).build();
}

std::vector<ViewCell> plantCells(uint64_t triangles, uint64_t seed) {
  const PlantLayout plant = drawPlant(triangles, seed);
  const uint32_t mi = (plant.nx - 1) / 2, mj = (plant.nz - 1) / 2;
  const double x = plant.aisle(mi), z = plant.aisle(mj);
  const double w = plant.width(), d = plant.depth();
  const double up = plant.storeys > 1 ? kStorey : 0, top = kStorey * double(plant.storeys);
  return {
      {"flat-1", {x, 1.6, 1}, {2.4, 2.4, 0}, {0, 0, 0}},
      {"flat-2", {w - 1, up + 1.6, z}, {2.4, 2.4, 0}, {0, -90, 0}},
      {"flat-3", {x, up + 1.6, z}, {2, 2, 0}, {0, 40, 0}},
      {"flat-4", {w / 2, top + 14, -10}, {20, 10, 0}, {35, 10, 0}},
      {"box-1", {x, 1.6, z}, {2.6, 2.6, 2.6}, {0, 0, 0}},
      {"box-2", {x, up + 1.6, z}, {1, 1, 1}, {0, 45, 0}},
      {"box-3", {w / 2, top + 8, d / 2}, {12, 6, 12}, {0, 20, 0}},
      {"street-1", {x, 1.5, d / 2}, {1.6, 2, std::min(150.0, d - 1)}, {0, 0, 0}},
      {"street-2", {w / 2, up + 1.5, z}, {1.6, 2, std::min(150.0, w - 1)}, {0, 90, 0}},
      {"street-3", {-6, 1.8, d / 2}, {2.5, 2, std::min(150.0, d)}, {0, 0, 0}},
  };
}

CameraPath plantWalk(uint64_t triangles, uint64_t seed, uint32_t frames) {
  const PlantLayout plant = drawPlant(triangles, seed);
  constexpr double kEye = 1.6, kBeside = -6;  // of the bays
  const double x = plant.aisle((plant.nx - 1) / 2), z = plant.aisle((plant.nz - 1) / 2);
  const double w = plant.width(), d = plant.depth();
  const double up = (plant.storeys > 1 ? kStorey : 0) + kEye, top = kStorey * double(plant.storeys);
  WalkPlan plan(frames);
  plan.key(0, {x, kEye, 1}, {x, kEye, 11});
  plan.turn(kTurnFrom, kTurnTo, {x, kEye, z}, 0, -270);
  plan.key(kSecondTo, {w - 1, kEye, z}, {w + 9, kEye, z});
  plan.cut(kSideFrom, {w - 1, up, z}, {w - 11, up, z});
  plan.key(kSideTo, {1, up, z}, {-9, up, z});
  plan.cut(kRiseFrom, {kBeside, kEye, d / 2}, {4, kEye, d / 2});
  plan.key(0.8, {kBeside, top, d / 2}, {4, top / 2, d / 2});
  plan.key(0.84, {kBeside, top + 8, d / 2}, {8, top / 2, d / 2});
  plan.seeAll({w / 2, 0, d / 2}, std::max(w, d) + 2 * kMargin + 40, {-1, 0, 0});
  return plan.path();
}

}  // namespace sightline

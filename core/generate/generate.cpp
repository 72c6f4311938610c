#include "core/generate/generate.h"

#include "core/base/error.h"
#include "core/generate/scene_generators.h"

namespace sightline {
namespace {

struct Generator {
  GeneratedSceneInfo info;
  std::vector<ScenePart> (*parts)(uint64_t triangles, uint64_t seed);  ///< nullptr: of no parts (scan)
  std::vector<ViewCell> (*cells)(uint64_t triangles, uint64_t seed);
  CameraPath (*walk)(uint64_t triangles, uint64_t seed, uint32_t frames);
  uint64_t most = kMaxGeneratedTriangles;
};

const std::vector<Generator>& generators() {
  static const std::vector<Generator> all = {
      {{"city", "streets in a grid, facades with recessed windows and ledges, trees, cars"},
       cityParts,
       [](uint64_t triangles, uint64_t seed) { return cityCells(triangles, seed); },
       [](uint64_t triangles, uint64_t seed, uint32_t frames) { return cityWalk(triangles, seed, frames); }},
      {{"canyon", "terrain with overhanging cliffs, bridges and arches of rock, hoodoos, boulders"},
       canyonParts,
       canyonCells,
       canyonWalk},
      {{"plant", "storeys of pipes with bends, tanks, gratings and steel: heavy occlusion"},
       plantParts,
       plantCells,
       plantWalk},
      {{"bistro", "a street of cafes: tables, chairs, cups, lamps, plants, balls of thin fibres"},
       bistroParts,
       bistroCells,
       bistroWalk},
      {{"scan", "a statue as one closed surface of fine, noisy triangles: many to a pixel"},
       nullptr,
       [](uint64_t, uint64_t) { return scanCells(); },
       [](uint64_t, uint64_t, uint32_t frames) { return scanWalk(frames); },
       kMaxScanTriangles},
  };
  return all;
}

/// repeated: modules repeat, so that more triangles fit.
const Generator& find(const std::string& name, uint64_t triangles, bool repeated = false) {
  std::string names;
  for (const Generator& g : generators()) {
    if (g.info.name == name) {
      const uint64_t most = repeated ? kMaxRepeatedTriangles : g.most;
      if (triangles >= kMinGeneratedTriangles && triangles <= most) return g;
      throw Error("triangle count " + std::to_string(triangles) + " is out of range " +
                      std::to_string(kMinGeneratedTriangles) + ".." + std::to_string(most) +
                      (repeated ? "" : " of the scene '" + name + "'"),
                  kExitUsage);
    }
    names += (names.empty() ? "" : ", ") + g.info.name;
  }
  throw Error("no generated scene is called '" + name + "': there are " + names, kExitUsage);
}

void checkRepeated(const std::string& name, uint64_t triangles, uint32_t kinds) {
  find(name, triangles, true);
  if (!canRepeat(name)) {
    throw Error("the scene '" + name + "' has nothing that repeats: city and plant have", kExitUsage);
  }
  if (kinds < 1 || kinds > kMaxKinds) {
    throw Error(
        "number of kinds " + std::to_string(kinds) + " is out of range 1.." + std::to_string(kMaxKinds),
        kExitUsage);
  }
}

}  // namespace

const std::vector<GeneratedSceneInfo>& generatedScenes() {
  static const std::vector<GeneratedSceneInfo> infos = [] {
    std::vector<GeneratedSceneInfo> list;
    for (const Generator& g : generators()) list.push_back(g.info);
    return list;
  }();
  return infos;
}

namespace {

/// Of a scene that find() knows.
void checkExtras(const std::string& name, const SceneExtras& extras) {
  if (extras.alpha && name != "city" && name != "bistro") {
    throw Error("the scene '" + name + "' has neither leaves nor panes: city and bistro have", kExitUsage);
  }
  if (extras.closed && name != "city") {
    throw Error("the scene '" + name + "' " +
                    (name == "scan" ? "is closed without holes" : "has no closed form: city has"),
                kExitUsage);
  }
  if (extras.closed && extras.alpha) {
    throw Error("a house with windows of glass is not closed: ask for alpha or for closed", kExitUsage);
  }
  if (extras.holes && name != "scan") {
    throw Error("the scene '" + name + "' has no holes of a scanner: scan has", kExitUsage);
  }
}

/// All of a stream.
Scene collect(const SceneStream& stream) {
  Scene scene;
  scene.objects = stream.objects;
  scene.positions.reserve(stream.vertices);
  scene.triangles.reserve(stream.triangleCount());
  stream.positions([&](std::span<const glm::vec3> some) {
    scene.positions.insert(scene.positions.end(), some.begin(), some.end());
  });
  stream.triangles([&](std::span<const glm::uvec3> some) {
    scene.triangles.insert(scene.triangles.end(), some.begin(), some.end());
  });
  return scene;
}

}  // namespace

SceneStream streamScan(uint64_t triangles, uint64_t seed, const SceneExtras& extras,
                       const std::function<void(uint32_t vertices, uint32_t of)>& measured) {
  find("scan", triangles);
  checkExtras("scan", extras);
  return scanStream(triangles, seed, extras.holes, measured);
}

Scene generateScene(const std::string& name, uint64_t triangles, uint64_t seed, const SceneExtras& extras) {
  const Generator& generator = find(name, triangles);
  checkExtras(name, extras);
  if (generator.parts == nullptr) return collect(scanStream(triangles, seed, extras.holes, {}));
  return assembleScene(generator.parts(triangles, seed), triangles, seed, {extras.alpha, extras.closed});
}

bool canRepeat(const std::string& name) {
  return name == "city" || name == "plant";
}

Scene generateRepeated(const std::string& name, uint64_t triangles, uint64_t seed, uint32_t kinds,
                       bool closed) {
  checkRepeated(name, triangles, kinds);
  if (closed && name != "city") {
    throw Error("the scene '" + name + "' has no closed form: city has", kExitUsage);
  }
  return assembleModules((name == "city" ? repeatedCity : repeatedPlant)(triangles, seed, kinds), triangles,
                         seed, {.closed = closed});
}

std::vector<ViewCell> generateRepeatedCells(const std::string& name, uint64_t triangles, uint64_t seed,
                                            uint32_t kinds) {
  checkRepeated(name, triangles, kinds);
  return name == "city" ? cityCells(triangles, seed, true) : plantCells(triangles, seed);
}

CameraPath generateWalk(const std::string& name, uint64_t triangles, uint64_t seed, uint32_t frames,
                        uint32_t kinds) {
  if (kinds > 0) checkRepeated(name, triangles, kinds);
  const Generator& generator = find(name, triangles, kinds > 0);
  if (frames < kMinWalkFrames || frames > kMostPathFrames) {
    throw Error("number of frames " + std::to_string(frames) + " is out of range " +
                    std::to_string(kMinWalkFrames) + ".." + std::to_string(kMostPathFrames),
                kExitUsage);
  }
  return kinds > 0 && name == "city" ? cityWalk(triangles, seed, frames, true)
                                     : generator.walk(triangles, seed, frames);
}

std::vector<ViewCell> generateCells(const std::string& name, uint64_t triangles, uint64_t seed) {
  return find(name, triangles).cells(triangles, seed);
}

}  // namespace sightline

#include "core/generate/generate.h"

#include "core/base/error.h"
#include "core/generate/scene_generators.h"

namespace sightline {
namespace {

struct Generator {
  GeneratedSceneInfo info;
  std::vector<ScenePart> (*parts)(uint64_t triangles, uint64_t seed);
  std::vector<ViewCell> (*cells)(uint64_t triangles, uint64_t seed);
};

const std::vector<Generator>& generators() {
  static const std::vector<Generator> all = {
      {{"city", "streets in a grid, facades with recessed windows and ledges, trees, cars"},
       cityParts,
       cityCells},
      {{"canyon", "terrain with overhanging cliffs, bridges and arches of rock, hoodoos, boulders"},
       canyonParts,
       canyonCells},
      {{"plant", "storeys of pipes with bends, tanks, gratings and steel: heavy occlusion"},
       plantParts,
       plantCells},
      {{"bistro", "a street of cafes: tables, chairs, cups, lamps, plants, balls of thin fibres"},
       bistroParts,
       bistroCells},
  };
  return all;
}

const Generator& find(const std::string& name, uint64_t triangles) {
  if (triangles < kMinGeneratedTriangles || triangles > kMaxGeneratedTriangles) {
    throw Error("triangle count " + std::to_string(triangles) + " is out of range " +
                    std::to_string(kMinGeneratedTriangles) + ".." + std::to_string(kMaxGeneratedTriangles),
                kExitUsage);
  }
  std::string names;
  for (const Generator& g : generators()) {
    if (g.info.name == name) return g;
    names += (names.empty() ? "" : ", ") + g.info.name;
  }
  throw Error("no generated scene is called '" + name + "': there are " + names, kExitUsage);
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

Scene generateScene(const std::string& name, uint64_t triangles, uint64_t seed) {
  return assembleScene(find(name, triangles).parts(triangles, seed), triangles, seed);
}

std::vector<ViewCell> generateCells(const std::string& name, uint64_t triangles, uint64_t seed) {
  return find(name, triangles).cells(triangles, seed);
}

}  // namespace sightline

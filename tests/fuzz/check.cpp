#include "tests/fuzz/check.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "core/base/error.h"
#include "core/formats/glb_bytes.h"
#include "core/formats/loaders.h"
#include "core/formats/obj_text.h"
#include "core/formats/scene_builder.h"
#include "core/scene/instances.h"

namespace sightline::fuzz {
namespace {

/// No such folder, so files that a scene names are never there.
const std::string kFolder = "/no-such-folder/";

bool isControl(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

void requireLine(const std::string& line) {
  for (const char c : line) require(!isControl(c), "a control character in: " + line);
}

/// What scene.h promises.
void requireInvariants(const Scene& scene) {
  require(!scene.triangles.empty(), "a scene without triangles");
  for (const glm::vec3& p : scene.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      require(std::abs(p[axis]) <= kLargestCoordinate, "a coordinate out of range");
    }
  }
  for (const glm::uvec3& t : scene.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      require(t[corner] < scene.positions.size(), "a corner out of range");
    }
  }
  uint64_t next = 0;
  for (const SceneObject& object : scene.objects) {
    require(object.first_triangle == next, "objects that do not follow one another");
    require(object.triangle_count != 0, "an object without triangles");
    require(!object.name.empty() && cleanName(object.name) == object.name, "an unclean name: " + object.name);
    next += object.triangle_count;
  }
  require(next == scene.triangles.size(), "triangles of no object");
  for (const uint64_t count : {scene.degenerate_triangles, scene.alpha_triangles, scene.glass_triangles,
                               scene.single_sided_triangles}) {
    require(count <= scene.triangles.size(), "more triangles of a kind than there are");
  }
  for (const std::string& warning : scene.warnings) requireLine(warning);
}

bool sameBits(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(glm::vec3)) == 0;
}

void requireSame(const Scene& a, const Scene& b, const std::string& where) {
  require(sameBits(a.positions, b.positions), "other positions " + where);
  require(a.triangles == b.triangles, "other triangles " + where);
  require(a.objects.size() == b.objects.size(), "more or fewer objects " + where);
  for (size_t i = 0; i < a.objects.size(); ++i) {
    require(a.objects[i].name == b.objects[i].name &&
                a.objects[i].first_triangle == b.objects[i].first_triangle &&
                a.objects[i].triangle_count == b.objects[i].triangle_count,
            "another object " + where);
  }
}

Scene reload(const std::string& extension, const std::string& bytes) {
  return parseScene(fileBytes(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()),
                    kFolder + "again" + extension, {});
}

void requireRoundTrips(const Scene& scene) {
  if (scene.offset != glm::dvec3(0.0)) return;  // put back in double, it may round
  std::string obj, glb;
  if (!scene.surfaces.empty()) {  // vertices of masked triangles may come back as several, and OBJ has none
    writeGlb(scene, "again", [&](std::string_view piece) { glb += piece; });
    const Scene again = reload(".glb", glb);
    require(flatten(again).surfaces.words == flatten(scene).surfaces.words, "other surfaces after GLB");
    for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
      const auto a = scene.corners(id), b = again.corners(id);
      require(std::memcmp(&a, &b, sizeof(a)) == 0, "another corner after GLB");
    }
    return;
  }
  writeObj(scene, "again", [&](std::string_view piece) { obj += piece; });
  requireSame(scene, reload(".obj", obj), "after OBJ");
  writeGlb(scene, "again", [&](std::string_view piece) { glb += piece; });
  requireSame(scene, reload(".glb", glb), "after GLB");
}

}  // namespace

void require(bool condition, const std::string& what) {
  if (condition) return;
  std::fprintf(stderr, "not as promised: %s\n", what.c_str());
  std::abort();
}

FileBytes fileBytes(const uint8_t* data, size_t size) {
  FileBytes bytes{std::make_unique_for_overwrite<char[]>(size), size};
  std::memcpy(bytes.data.get(), data, size);
  return bytes;
}

void expectLine(const std::string& name, const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& error) {
    const std::string line = error.what();
    requireLine(line);
    require(line.starts_with(name), "an error that does not name its file: " + line);
  }
}

void checkScene(const std::string& extension, const uint8_t* data, size_t size) {
  const std::string name = kFolder + "a" + extension;
  std::optional<Scene> plain, repaired;
  expectLine(name, [&] { plain = parseScene(fileBytes(data, size), name, {}); });
  expectLine(name, [&] { repaired = parseScene(fileBytes(data, size), name, {.repair = true}); });
  if (repaired) requireInvariants(*repaired);
  if (!plain) return;
  requireInvariants(*plain);
  require(plain->repaired_triangles == 0, "triangles dropped unasked");
  require(repaired.has_value(), "repair refuses what is sound");
  requireSame(*plain, *repaired, "after repair");
  requireRoundTrips(*plain);
}

}  // namespace sightline::fuzz

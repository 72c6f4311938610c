#include "core/formats/save_scene.h"

#include <fmt/format.h>

#include <charconv>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <span>

#include "core/base/error.h"
#include "core/formats/glb_bytes.h"
#include "core/formats/obj_text.h"
#include "core/formats/scene_builder.h"
#include "core/io/file_io.h"
#include "core/scene/instances.h"
#include "core/scene/scene.h"

namespace sightline {
namespace {

using nlohmann::json;

using WriteText = std::function<void(std::string_view)>;

/// Collects text and passes it on in large pieces.
class TextWriter {
 public:
  explicit TextWriter(const WriteText& write) : write_(write) {}
  ~TextWriter() = default;
  TextWriter(const TextWriter&) = delete;
  TextWriter& operator=(const TextWriter&) = delete;

  void text(std::string_view value) {
    buffer_.append(value);
    if (buffer_.size() > kPiece) flush();
  }
  /// A blank and the number; floats as the shortest decimal that reads back to the same bits.
  template <typename Number>
  void number(Number value) {
    char digits[32];
    digits[0] = ' ';
    const auto result = std::to_chars(digits + 1, digits + sizeof(digits), value);
    buffer_.append(digits, size_t(result.ptr - digits));
  }
  void flush() {
    write_(buffer_);
    buffer_.clear();
  }

 private:
  static constexpr size_t kPiece = 1 << 20;
  const WriteText& write_;
  std::string buffer_;
};

/// Smallest and largest coordinates of a run of positions, which glTF asks for.
std::pair<json, json> positionRange(const Scene& scene, size_t first, size_t count) {
  glm::vec3 low = count > 0 ? scene.positions[first] : glm::vec3(0);
  glm::vec3 high = low;
  for (const glm::vec3& position : std::span(scene.positions).subspan(first, count)) {
    low = glm::min(low, position);
    high = glm::max(high, position);
  }
  return {json{low.x, low.y, low.z}, json{high.x, high.y, high.z}};
}

/// A mesh of a scene as a file holds it: an accessor of its positions, and meshes of the file by the runs of
/// its triangles that objects show.
struct SavedMesh {
  size_t positions = 0;
  std::map<std::pair<uint32_t, uint32_t>, size_t> runs;
};

/// offset: of the scene, put back.
json matrixOf(const Placement& place, const glm::dvec3& offset) {
  json matrix = json::array();
  for (const vec4* column : {&place.x, &place.y, &place.z, &place.origin}) {
    for (int row = 0; row < 3; ++row) {
      const double value = (*column)[row];
      matrix.push_back(column == &place.origin ? value + offset[row] : value);
    }
    matrix.push_back(column == &place.origin ? 1 : 0);
  }
  return matrix;
}

/// One node and mesh an object; all share one position accessor, so that positions stay as they are. What
/// instances show is a mesh that their nodes share, with an accessor of its own.
json gltfDocument(const Scene& scene, uint64_t position_bytes, uint64_t triangle_bytes) {
  constexpr int kFloat = 5126;
  constexpr int kUnsignedInt = 5125;
  constexpr int kArrayBuffer = 34962;
  constexpr int kElementArrayBuffer = 34963;
  const auto [low, high] = positionRange(scene, 0, scene.plainPositions());
  json document = {{"asset", {{"version", "2.0"}, {"generator", "Sightline"}}}, {"scene", 0}};
  document["materials"] = {{{"doubleSided", scene.single_sided_triangles == 0}}};
  document["buffers"] = {{{"byteLength", position_bytes + triangle_bytes}}};
  document["bufferViews"] = {{{"buffer", 0}, {"byteLength", position_bytes}, {"target", kArrayBuffer}},
                             {{"buffer", 0},
                              {"byteOffset", position_bytes},
                              {"byteLength", triangle_bytes},
                              {"target", kElementArrayBuffer}}};
  json accessors = {{{"bufferView", 0},
                     {"componentType", kFloat},
                     {"count", scene.plainPositions()},
                     {"type", "VEC3"},
                     {"min", low},
                     {"max", high}}};
  if (scene.plainPositions() == 0) accessors = json::array();
  std::vector<SavedMesh> saved;
  for (const SceneMesh& mesh : scene.meshes) {
    const auto [from, to] = positionRange(scene, mesh.first_position, mesh.position_count);
    saved.push_back({accessors.size(), {}});
    accessors.push_back({{"bufferView", 0},
                         {"byteOffset", uint64_t(mesh.first_position) * sizeof(glm::vec3)},
                         {"componentType", kFloat},
                         {"count", mesh.position_count},
                         {"type", "VEC3"},
                         {"min", from},
                         {"max", to}});
  }
  json meshes = json::array();
  json nodes = json::array();
  json roots = json::array();
  const auto addMesh = [&](size_t positions, uint32_t first_triangle, uint32_t count) {
    const json primitive = {
        {"attributes", {{"POSITION", positions}}}, {"indices", accessors.size()}, {"material", 0}};
    meshes.push_back({{"primitives", json::array({primitive})}});
    accessors.push_back({{"bufferView", 1},
                         {"byteOffset", uint64_t(first_triangle) * sizeof(glm::uvec3)},
                         {"componentType", kUnsignedInt},
                         {"count", uint64_t(count) * 3},
                         {"type", "SCALAR"}});
    return meshes.size() - 1;
  };
  for (const SceneObject& object : scene.objects) {
    roots.push_back(nodes.size());
    const StoredTriangle at = scene.hasInstances() ? scene.stored(object.first_triangle)
                                                   : StoredTriangle{object.first_triangle, kNoTriangle};
    if (at.instance == kNoTriangle) {
      nodes.push_back({{"mesh", addMesh(0, at.triangle, object.triangle_count)}, {"name", object.name}});
      if (scene.offset != glm::dvec3(0.0)) {
        nodes.back()["translation"] = {scene.offset.x, scene.offset.y, scene.offset.z};
      }
      continue;
    }
    const SceneInstance& instance = scene.instances[at.instance];
    SavedMesh& mesh = saved[instance.mesh];
    const auto [run, is_new] = mesh.runs.try_emplace({at.triangle, object.triangle_count}, 0);
    if (is_new) run->second = addMesh(mesh.positions, at.triangle, object.triangle_count);
    nodes.push_back(
        {{"mesh", run->second}, {"name", object.name}, {"matrix", matrixOf(instance.place, scene.offset)}});
  }
  document["accessors"] = std::move(accessors);
  document["meshes"] = std::move(meshes);
  document["nodes"] = std::move(nodes);
  document["scenes"] = {{{"nodes", std::move(roots)}}};
  return document;
}

/// The names must come back as they are.
void checkWritable(const Scene& scene, const std::string& file) {
  if (scene.triangles.empty()) throw Error(fmt::format("{}: the scene holds no triangles", file));
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const std::string& name = scene.objects[i].name;
    if (!name.empty() && cleanName(name) == name) continue;
    throw Error(
        fmt::format("{}: object {} has a name that a file cannot hold: it is empty, not UTF-8, or has "
                    "control characters or blanks at an end",
                    file, i));
  }
}

}  // namespace

void writeObj(const Scene& scene, const std::string& name, const WriteText& write) {
  checkWritable(scene, name);
  TextWriter writer(write);
  if (scene.hasInstances()) return writeObj(flatten(scene), name, write);  // OBJ has none
  for (const glm::vec3& position : scene.positions) {
    writer.text("v");
    for (int i = 0; i < 3; ++i) {
      if (scene.offset[i] == 0.0) {
        writer.number(position[i]);
      } else {
        writer.number(double(position[i]) + scene.offset[i]);
      }
    }
    writer.text("\n");
  }
  for (const SceneObject& object : scene.objects) {
    writer.text("o " + object.name + "\n");
    for (uint32_t i = 0; i < object.triangle_count; ++i) {
      writer.text("f");
      for (int corner = 0; corner < 3; ++corner) {
        writer.number(uint64_t(scene.triangles[object.first_triangle + i][corner]) + 1);
      }
      writer.text("\n");
    }
  }
  writer.flush();
}

void writeGlb(const Scene& scene, const std::string& name, const WriteText& write) {
  checkWritable(scene, name);
  const uint64_t position_bytes = scene.positions.size() * sizeof(glm::vec3);
  const uint64_t triangle_bytes = scene.triangles.size() * sizeof(glm::uvec3);
  std::string text = gltfDocument(scene, position_bytes, triangle_bytes).dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const uint64_t bin_bytes = position_bytes + triangle_bytes;  // a multiple of 4
  const uint64_t total = 12 + 8 + text.size() + 8 + bin_bytes;
  if (total > 0xffffffffull) {
    throw Error(
        fmt::format("{}: needs {} bytes, but a GLB holds less than 4 GiB; write .obj instead", name, total));
  }
  const uint32_t header[5] = {0x46546c67, 2, uint32_t(total), uint32_t(text.size()), 0x4e4f534a};
  const uint32_t bin_header[2] = {uint32_t(bin_bytes), 0x004e4942};
  const auto writeBytes = [&](const void* bytes, uint64_t size) {
    write({static_cast<const char*>(bytes), size});
  };
  writeBytes(header, sizeof(header));
  write(text);
  writeBytes(bin_header, sizeof(bin_header));
  writeBytes(scene.positions.data(), position_bytes);
  if (!scene.hasInstances()) {
    writeBytes(scene.triangles.data(), triangle_bytes);
    return;
  }
  // Indices into the accessors of meshes begin at 0.
  std::vector<glm::uvec3> triangles = scene.triangles;
  for (const SceneMesh& mesh : scene.meshes) {
    for (glm::uvec3& t : std::span(triangles).subspan(mesh.first_triangle, mesh.triangle_count)) {
      t -= mesh.first_position;
    }
  }
  writeBytes(triangles.data(), triangle_bytes);
}

void saveScene(const Scene& scene, const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::string extension = lowerExtension(file);
  if (extension != ".obj" && extension != ".glb") {
    throw Error(fmt::format("{}: unknown extension \"{}\", expected .obj or .glb", name, extension));
  }
  checkWritable(scene, name);
  OutputFile output(file);
  (extension == ".obj" ? writeObj : writeGlb)(scene, name,
                                              [&output](std::string_view piece) { output.write(piece); });
  output.commit();
}

}  // namespace sightline

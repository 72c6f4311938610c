#include "core/formats/save_scene.h"

#include <fmt/format.h>

#include <charconv>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/formats/glb_bytes.h"
#include "core/formats/obj_text.h"
#include "core/formats/scene_builder.h"
#include "core/io/file_io.h"
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

/// Smallest and largest coordinates over all positions, which glTF asks for.
std::pair<json, json> positionRange(const Scene& scene) {
  glm::vec3 low = scene.positions.at(0);
  glm::vec3 high = low;
  for (const glm::vec3& position : scene.positions) {
    low = glm::min(low, position);
    high = glm::max(high, position);
  }
  return {json{low.x, low.y, low.z}, json{high.x, high.y, high.z}};
}

/// One node and mesh an object; all share one position accessor, so that positions stay as they are.
json gltfDocument(const Scene& scene, uint64_t position_bytes, uint64_t triangle_bytes) {
  constexpr int kFloat = 5126;
  constexpr int kUnsignedInt = 5125;
  constexpr int kArrayBuffer = 34962;
  constexpr int kElementArrayBuffer = 34963;
  const auto [low, high] = positionRange(scene);
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
                     {"count", scene.positions.size()},
                     {"type", "VEC3"},
                     {"min", low},
                     {"max", high}}};
  json meshes = json::array();
  json nodes = json::array();
  json roots = json::array();
  for (const SceneObject& object : scene.objects) {
    roots.push_back(nodes.size());
    nodes.push_back({{"mesh", meshes.size()}, {"name", object.name}});
    if (scene.offset != glm::dvec3(0.0)) {
      nodes.back()["translation"] = {scene.offset.x, scene.offset.y, scene.offset.z};
    }
    const json primitive = {
        {"attributes", {{"POSITION", 0}}}, {"indices", accessors.size()}, {"material", 0}};
    meshes.push_back({{"primitives", json::array({primitive})}});
    accessors.push_back({{"bufferView", 1},
                         {"byteOffset", uint64_t(object.first_triangle) * sizeof(glm::uvec3)},
                         {"componentType", kUnsignedInt},
                         {"count", uint64_t(object.triangle_count) * 3},
                         {"type", "SCALAR"}});
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
  writeBytes(scene.triangles.data(), triangle_bytes);
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

// Based on: Khronos Group, glTF 2.0 Specification, 2021.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <span>

#include "core/base/error.h"
#include "core/formats/glb_bytes.h"
#include "core/formats/mask_image.h"
#include "core/formats/saved_runs.h"
#include "core/scene/instances.h"
#include "core/scene/scene.h"

namespace sightline {
namespace {

using nlohmann::json;

constexpr int kFloat = 5126, kUnsignedInt = 5125, kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kNearestFilter = 9728;

std::pair<json, json> asRange(const Bounds& bounds) {
  return {json{bounds.low.x, bounds.low.y, bounds.low.z}, json{bounds.high.x, bounds.high.y, bounds.high.z}};
}

/// Smallest and largest coordinates of a run of positions, which glTF asks for.
std::pair<json, json> positionRange(std::span<const glm::vec3> positions) {
  glm::vec3 low = positions.empty() ? glm::vec3(0) : positions.front();
  glm::vec3 high = low;
  for (const glm::vec3& position : positions) {
    low = glm::min(low, position);
    high = glm::max(high, position);
  }
  return asRange({low, high});
}

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

int wrapMode(uint32_t wrap) {
  return wrap == kWrapMirror ? 33648 : wrap == kWrapClamp ? 33071 : 10497;
}

/// Makes the JSON of a file whose views are: positions; triangles; with masks, places in images, and an image
/// each.
class GltfWriter {
 public:
  GltfWriter(const Scene& scene, const SavedRuns& saved)
      : scene_(scene),
        saved_(saved),
        positions_(saved.triangles.empty() ? scene.positions : saved.positions),
        position_count_(positions_.size()),
        shared_positions_(saved.triangles.empty() ? scene.plainPositions() : saved.shared_positions) {}
  /// Of a scene whose positions are not there yet: so many, within these bounds.
  GltfWriter(const Scene& scene, const SavedRuns& saved, uint32_t positions, const Bounds& bounds)
      : scene_(scene),
        saved_(saved),
        position_count_(positions),
        shared_positions_(positions),
        bounds_(bounds) {}

  /// image_bytes: of the masks' images, in order.
  json document(uint64_t triangle_bytes, const std::vector<uint64_t>& image_bytes) {
    document_ = {{"asset", {{"version", "2.0"}, {"generator", "Sightline"}}}, {"scene", 0}};
    document_["bufferViews"] = json::array();
    addView(position_count_ * sizeof(glm::vec3), kArrayBuffer);
    addView(triangle_bytes, kElementArrayBuffer);
    if (!image_bytes.empty()) addView(saved_.places.size() * sizeof(glm::vec2), kArrayBuffer);
    for (const uint64_t bytes : image_bytes) addView(bytes, {});
    document_["buffers"] = {{{"byteLength", bytes_}}};
    addMaterials();
    addTextures();
    if (shared_positions_ != 0) addPositions(0, shared_positions_);
    for (const SceneMesh& mesh : scene_.meshes) {
      meshes_.push_back({addPositions(mesh.first_position, mesh.position_count), {}});
    }
    addNodes();
    document_["accessors"] = std::move(accessors_);
    document_["scenes"] = {{{"nodes", std::move(roots_)}}};
    return std::move(document_);
  }

 private:
  /// A mesh of a scene as a file holds it: an accessor of its positions, and meshes of the file by the runs
  /// of its triangles that objects show.
  struct SharedMesh {
    size_t positions = 0;
    std::map<std::pair<uint32_t, uint32_t>, size_t> runs;
  };

  void addView(uint64_t bytes, std::optional<int> target) {
    json view = {{"buffer", 0}, {"byteLength", bytes}};
    if (bytes_ != 0) view["byteOffset"] = bytes_;
    if (target) view["target"] = *target;
    document_["bufferViews"].push_back(std::move(view));
    bytes_ += (bytes + 3) / 4 * 4;
  }

  void addMaterials() {
    json& list = document_["materials"] = json::array();
    for (const SavedMaterial& material : saved_.materials) {
      json its = {{"doubleSided", material.double_sided}};
      if (material.mask) {
        its["alphaMode"] = "MASK";
        its["pbrMetallicRoughness"] = {
            {"baseColorTexture",
             {{"index", std::ranges::find(saved_.masks, *material.mask) - saved_.masks.begin()}}}};
      }
      if (material.glass && material.mask) {
        its["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}};
        document_["extensionsUsed"] = {"KHR_materials_transmission"};
      } else if (material.glass) {
        its["alphaMode"] = "BLEND";
        its["pbrMetallicRoughness"] = {{"baseColorFactor", {0.7, 0.85, 0.9, 0.3}}};
      }
      list.push_back(std::move(its));
    }
  }

  void addTextures() {
    constexpr size_t kViewsBefore = 3;
    for (size_t i = 0; i < saved_.masks.size(); ++i) {
      const uint32_t wraps = scene_.surfaces.masks[saved_.masks[i]].size_wrap_first.z;
      document_["images"].push_back({{"bufferView", kViewsBefore + i}, {"mimeType", "image/png"}});
      document_["samplers"].push_back({{"magFilter", kNearestFilter},
                                       {"minFilter", kNearestFilter},
                                       {"wrapS", wrapMode(wraps & 3u)},
                                       {"wrapT", wrapMode(wraps >> 2)}});
      document_["textures"].push_back({{"source", i}, {"sampler", i}});
    }
  }

  size_t addAccessor(json accessor, uint64_t offset) {
    if (offset != 0 || !accessor.contains("min")) accessor["byteOffset"] = offset;
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }

  size_t addPositions(uint32_t first, uint32_t count) {
    const auto [low, high] = bounds_ ? asRange(*bounds_) : positionRange(positions_.subspan(first, count));
    return addAccessor({{"bufferView", 0},
                        {"componentType", kFloat},
                        {"count", count},
                        {"type", "VEC3"},
                        {"min", low},
                        {"max", high}},
                       uint64_t(first) * sizeof(glm::vec3));
  }

  /// positions: the accessor, of runs that have none of their own.
  json primitive(const SavedRun& run, size_t positions) {
    json attributes;
    if (run.position_count != 0) {
      attributes["POSITION"] = addPositions(run.first_position, run.position_count);
      attributes["TEXCOORD_0"] = addAccessor(
          {{"bufferView", 2}, {"componentType", kFloat}, {"count", run.position_count}, {"type", "VEC2"}},
          uint64_t(run.first_position - shared_positions_) * sizeof(glm::vec2));
    } else {
      attributes["POSITION"] = positions;
    }
    const size_t indices = addAccessor({{"bufferView", 1},
                                        {"componentType", kUnsignedInt},
                                        {"count", uint64_t(run.triangle_count) * 3},
                                        {"type", "SCALAR"}},
                                       uint64_t(run.first_triangle) * sizeof(glm::uvec3));
    return {{"attributes", std::move(attributes)}, {"indices", indices}, {"material", run.material}};
  }

  size_t addMesh(json primitives) {
    document_["meshes"].push_back({{"primitives", std::move(primitives)}});
    return document_["meshes"].size() - 1;
  }

  /// A node and mesh an object. Those that are not masked share one position accessor, so that positions stay
  /// as they are; what instances show is a mesh that their nodes share, with an accessor of its own.
  void addNodes() {
    for (size_t i = 0; i < saved_.runs.size();) {
      const SavedRun& run = saved_.runs[i];
      const SceneObject& object = scene_.objects[run.object];
      roots_.push_back(document_["nodes"].size());
      const uint32_t instance =
          scene_.hasInstances() ? scene_.stored(object.first_triangle).instance : kNoTriangle;
      if (instance != kNoTriangle) {
        document_["nodes"].push_back(instanceNode(scene_.instances[instance], run, object.name));
        ++i;
        continue;
      }
      json primitives = json::array();
      for (; i < saved_.runs.size() && saved_.runs[i].object == run.object; ++i) {
        primitives.push_back(primitive(saved_.runs[i], 0));
      }
      json node = {{"mesh", addMesh(std::move(primitives))}, {"name", object.name}};
      const glm::dvec3& offset = scene_.offset;
      if (offset != glm::dvec3(0.0)) node["translation"] = {offset.x, offset.y, offset.z};
      document_["nodes"].push_back(std::move(node));
    }
  }

  json instanceNode(const SceneInstance& instance, const SavedRun& run, const std::string& name) {
    SharedMesh& mesh = meshes_[instance.mesh];
    const auto [entry, is_new] = mesh.runs.try_emplace({run.first_triangle, run.triangle_count}, 0);
    if (is_new) entry->second = addMesh(json::array({primitive(run, mesh.positions)}));
    return {{"mesh", entry->second}, {"name", name}, {"matrix", matrixOf(instance.place, scene_.offset)}};
  }

  const Scene& scene_;
  const SavedRuns& saved_;
  const std::span<const glm::vec3> positions_;
  const uint64_t position_count_;
  const uint32_t shared_positions_;
  const std::optional<Bounds> bounds_ = {};
  json document_;
  json accessors_ = json::array(), roots_ = json::array();
  uint64_t bytes_ = 0;
  std::vector<SharedMesh> meshes_;
};

using WriteBytes = std::function<void(std::string_view)>;

/// All of a file that is before its first buffer view.
void writeHead(const json& document, const std::string& name, const WriteBytes& write) {
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const uint64_t bin_bytes = document["buffers"][0]["byteLength"];  // a multiple of 4
  const uint64_t total = 12 + 8 + text.size() + 8 + bin_bytes;
  if (total > 0xffffffffull) {
    throw Error(
        fmt::format("{}: needs {} bytes, but a GLB holds less than 4 GiB; write .obj instead", name, total));
  }
  const uint32_t header[5] = {0x46546c67, 2, uint32_t(total), uint32_t(text.size()), 0x4e4f534a};
  const uint32_t bin_header[2] = {uint32_t(bin_bytes), 0x004e4942};
  write({reinterpret_cast<const char*>(header), sizeof(header)});
  write(text);
  write({reinterpret_cast<const char*>(bin_header), sizeof(bin_header)});
}

template <typename T>
std::string_view bytesOf(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

}  // namespace

void streamGlb(const SceneStream& stream, const std::string& name, const WriteBytes& write) {
  Scene shell;
  shell.objects = stream.objects;
  const SavedRuns saved = splitIntoRuns(shell);
  const uint64_t triangle_bytes = uint64_t(stream.triangleCount()) * sizeof(glm::uvec3);
  writeHead(GltfWriter(shell, saved, stream.vertices, stream.bounds).document(triangle_bytes, {}), name,
            write);
  stream.positions([&](std::span<const glm::vec3> some) { write(bytesOf(some)); });
  stream.triangles([&](std::span<const glm::uvec3> some) { write(bytesOf(some)); });
}

void writeGlb(const Scene& scene, const std::string& name, const WriteBytes& write) {
  checkWritable(scene, name);
  if (scene.hasInstances() && !scene.surfaces.empty()) return writeGlb(flatten(scene), name, write);
  const SavedRuns saved = splitIntoRuns(scene);
  const bool masked = !saved.triangles.empty();
  const std::vector<glm::vec3>& positions = masked ? saved.positions : scene.positions;
  std::vector<std::vector<uint8_t>> images;
  std::vector<uint64_t> image_bytes;
  for (const uint32_t mask : saved.masks) {
    images.push_back(maskImage(scene.surfaces, mask));
    image_bytes.push_back(images.back().size());
    images.back().resize((images.back().size() + 3) / 4 * 4, 0);
  }
  const uint64_t triangle_bytes = scene.triangles.size() * sizeof(glm::uvec3);
  writeHead(GltfWriter(scene, saved).document(triangle_bytes, image_bytes), name, write);
  const auto writeBytes = [&](const void* bytes, uint64_t size) {
    write({static_cast<const char*>(bytes), size});
  };
  writeBytes(positions.data(), positions.size() * sizeof(glm::vec3));
  if (!scene.hasInstances()) {
    writeBytes((masked ? saved.triangles : scene.triangles).data(), triangle_bytes);
    if (masked) writeBytes(saved.places.data(), saved.places.size() * sizeof(glm::vec2));
    for (const std::vector<uint8_t>& image : images) writeBytes(image.data(), image.size());
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

}  // namespace sightline

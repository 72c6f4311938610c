// glTF 2.0: container, nodes in the order of the scene's tree, and the triangles of their meshes.
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <map>
#include <set>

#include "core/error.h"
#include "core/scene/gltf_data.h"
#include "core/scene/gltf_document.h"
#include "core/scene/json_text.h"
#include "core/scene/loaders.h"
#include "core/scene/scene_builder.h"

namespace sightline {
namespace {

/// The two chunks of a GLB file.
struct Glb {
  std::string_view json;
  std::string_view bin;
};

uint32_t word(std::string_view bytes, size_t offset) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

/// The chunk whose header is at `offset`; moves the offset behind it.
std::pair<uint32_t, std::string_view> takeChunk(std::string_view bytes, size_t& offset,
                                                const std::string& name) {
  if (bytes.size() - offset < 8)
    throw Error(fmt::format("{}: chunk header cut off at byte {}", name, offset));
  const size_t length = word(bytes, offset);
  const uint32_t type = word(bytes, offset + 4);
  offset += 8;
  if (length > bytes.size() - offset) {
    throw Error(fmt::format("{}: chunk of {} bytes at byte {} is cut off after {}; is the file truncated?",
                            name, length, offset, bytes.size() - offset));
  }
  offset += length;
  return {type, bytes.substr(offset - length, length)};
}

Glb splitGlb(std::string_view bytes, const std::string& name) {
  constexpr uint32_t kMagic = 0x46546c67;
  constexpr uint32_t kJson = 0x4e4f534a;
  constexpr uint32_t kBin = 0x004e4942;
  if (bytes.size() < 12 || word(bytes, 0) != kMagic) {
    throw Error(fmt::format("{}: is no GLB file: it does not start with \"glTF\" and a header", name));
  }
  if (word(bytes, 4) != 2)
    throw Error(fmt::format("{}: GLB version {}, only 2 is supported", name, word(bytes, 4)));
  const size_t length = word(bytes, 8);
  if (length > bytes.size() || length < 20) {
    throw Error(fmt::format("{}: the header says {} bytes, the file has {}; is it truncated?", name, length,
                            bytes.size()));
  }
  bytes = bytes.substr(0, length);
  size_t offset = 12;
  const auto [type, json] = takeChunk(bytes, offset, name);
  if (type != kJson) throw Error(fmt::format("{}: the first chunk is not JSON", name));
  Glb glb{json, {}};
  while (offset < bytes.size()) {
    const auto [next_type, next] = takeChunk(bytes, offset, name);
    if (next_type == kBin && glb.bin.data() == nullptr) glb.bin = next;
  }
  return glb;
}

/// A mesh with its place in the world.
struct Instance {
  size_t node = 0;
  size_t mesh = 0;
  glm::dmat4 to_world{1.0};
};

/// The scene's meshes, parents before children. Each node may be reached once only.
std::vector<Instance> listInstances(const GltfDocument& document, const std::string& file) {
  struct Visit {
    size_t node;
    glm::dmat4 parent;
  };
  std::vector<Instance> instances;
  std::vector<bool> seen(document.nodes.size(), false);
  std::vector<Visit> stack;
  const auto push = [&](const std::vector<size_t>& nodes, const glm::dmat4& parent) {
    for (size_t i = nodes.size(); i-- > 0;) stack.push_back({nodes[i], parent});
  };
  push(document.roots, glm::dmat4(1.0));
  while (!stack.empty()) {
    const auto [index, parent] = stack.back();
    stack.pop_back();
    if (seen[index]) {
      throw Error(fmt::format("{}: nodes[{}]: occurs twice in the scene's tree", file, index));
    }
    seen[index] = true;
    const GltfNode& node = document.nodes[index];
    const glm::dmat4 to_world = parent * node.local;
    if (node.mesh) instances.push_back({index, *node.mesh, to_world});
    push(node.children, to_world);
  }
  return instances;
}

class GltfLoader {
 public:
  GltfLoader(const GltfDocument& document, GltfData& data, const std::string& name,
             const SceneLoadOptions& options)
      : document_(document), data_(data), name_(name), builder_(options) {}

  Scene load() {
    const std::vector<Instance> instances = listInstances(document_, name_);
    reserve(instances);
    for (const Instance& instance : instances) {
      const GltfMesh& mesh = document_.meshes[instance.mesh];
      for (size_t i = 0; i < mesh.primitives.size(); ++i) addPrimitive(instance, i);
    }
    return builder_.finish(name_);
  }

 private:
  /// Vertices are shared by the primitives that name the same accessor in the same place.
  struct VertexKey {
    size_t accessor;
    std::array<double, 16> to_world;
    bool operator<(const VertexKey& other) const {
      return accessor != other.accessor ? accessor < other.accessor : to_world < other.to_world;
    }
  };

  static VertexKey keyOf(size_t accessor, const glm::dmat4& to_world) {
    VertexKey key{accessor, {}};
    for (int i = 0; i < 16; ++i) key.to_world[size_t(i)] = to_world[i / 4][i % 4] + 0.0;
    return key;
  }

  static bool hasTriangles(const GltfPrimitive& primitive) {
    return primitive.mode >= 4 && primitive.positions;
  }

  uint64_t elementCount(const GltfPrimitive& primitive) const {
    return document_.accessors[primitive.indices ? *primitive.indices : *primitive.positions].count;
  }

  static uint64_t triangleCount(const GltfPrimitive& primitive, uint64_t elements) {
    if (primitive.mode == 4) return elements / 3;
    return elements < 3 ? 0 : elements - 2;
  }

  /// Makes room for everything at once, and refuses what this machine could never hold: a small file may
  /// place a mesh any number of times.
  void reserve(const std::vector<Instance>& instances) {
    uint64_t positions = 0;
    uint64_t triangles = 0;
    std::set<VertexKey> seen;
    std::set<size_t> index_accessors;
    for (const Instance& instance : instances) {
      for (const GltfPrimitive& primitive : document_.meshes[instance.mesh].primitives) {
        if (!hasTriangles(primitive)) continue;
        triangles += triangleCount(primitive, elementCount(primitive));
        if (primitive.indices) index_accessors.insert(*primitive.indices);
        if (seen.insert(keyOf(*primitive.positions, instance.to_world)).second) {
          positions += document_.accessors[*primitive.positions].count;
        }
        if (positions > kMaxElements || triangles > kMaxElements) {
          throw Error(fmt::format("{}: more than {} vertices or triangles", name_, kMaxElements));
        }
      }
    }
    const uint64_t bytes = (positions + triangles) * 12;
    const uint64_t memory = uint64_t(sysconf(_SC_PHYS_PAGES)) * uint64_t(sysconf(_SC_PAGE_SIZE));
    if (bytes > memory) {
      throw Error(fmt::format("{}: {} vertices and {} triangles need more memory than this machine has",
                              name_, positions, triangles));
    }
    for (const VertexKey& key : seen) checkPositions(key.accessor);
    for (const size_t accessor : index_accessors) checkIndices(accessor);
    builder_.reserve(positions, triangles);
  }

  /// Sees, before room is made for it, that the data is there. (Sparse values alone, over zeros that no view
  /// holds, are refused too: they make no mesh, and would let a small file claim any count.)
  void checkPositions(size_t accessor) {
    const GltfAccessor& positions = document_.accessors[accessor];
    if (positions.width != 3) {
      throw Error(fmt::format("{}: accessors[{}].type: positions need VEC3", name_, accessor));
    }
    if (!positions.view) {
      throw Error(fmt::format("{}: accessors[{}]: positions without a bufferView", name_, accessor));
    }
    GltfReader(document_, data_, accessor, name_);
  }

  void checkIndices(size_t accessor) {
    const GltfAccessor& indices = document_.accessors[accessor];
    const bool whole = indices.component == GltfComponent::kUnsignedByte ||
                       indices.component == GltfComponent::kUnsignedShort ||
                       indices.component == GltfComponent::kUnsignedInt;
    if (!whole || indices.width != 1) {
      throw Error(
          fmt::format("{}: accessors[{}]: indices need SCALAR of 5121, 5123 or 5125", name_, accessor));
    }
    if (!indices.view) {
      throw Error(fmt::format("{}: accessors[{}]: indices without a bufferView", name_, accessor));
    }
    GltfReader(document_, data_, accessor, name_);
  }

  VertexRange addVertices(size_t accessor, const glm::dmat4& to_world) {
    const VertexKey key = keyOf(accessor, to_world);
    const auto found = vertices_.find(key);
    if (found != vertices_.end()) return found->second;
    const bool identity = to_world == glm::dmat4(1.0);
    GltfReader reader(document_, data_, accessor, name_);
    const VertexRange range{int64_t(builder_.positionCount()), int64_t(reader.count()), 0};
    for (uint64_t i = 0; i < reader.count(); ++i) {
      glm::dvec3 position(reader.component(i, 0), reader.component(i, 1), reader.component(i, 2));
      if (!identity) position = glm::dvec3(to_world * glm::dvec4(position, 1.0));  // keeps -0.0 and every bit
      builder_.addPosition(glm::vec3(position), position,
                           [&] { return fmt::format("{}: accessors[{}], element {}", name_, accessor, i); });
    }
    vertices_.emplace(key, range);
    return range;
  }

  void addPrimitive(const Instance& instance, size_t index) {
    const GltfPrimitive& primitive = document_.meshes[instance.mesh].primitives[index];
    if (!hasTriangles(primitive)) return;
    beginObject(instance, index);
    const VertexRange vertices = addVertices(*primitive.positions, instance.to_world);
    const uint64_t before = builder_.triangleCount();
    const uint64_t elements = elementCount(primitive);
    const std::string place = fmt::format("{}: meshes[{}].primitives[{}]", name_, instance.mesh, index);
    if (primitive.mode == 4 && elements % 3 != 0) {
      if (!builder_.repairs()) {
        throw Error(
            fmt::format("{}: {} corners are no multiple of 3; --repair drops the last", place, elements));
      }
      builder_.countRepaired(1);
    }
    if (primitive.indices) {
      addIndexed(primitive, vertices, place);
    } else {
      addTriangles(primitive.mode, elements, vertices, place, [](uint64_t i) { return i; });
    }
    const uint64_t added = builder_.triangleCount() - before;
    if (primitive.material.alpha) builder_.countAlpha(added);
    if (!primitive.material.double_sided) builder_.countSingleSided(added);
  }

  void addIndexed(const GltfPrimitive& primitive, const VertexRange& vertices, const std::string& place) {
    const size_t index = *primitive.indices;
    GltfReader reader(document_, data_, index, name_);
    const std::string where = fmt::format("{}, indices in accessors[{}]", place, index);
    addTriangles(primitive.mode, reader.count(), vertices, where,
                 [&](uint64_t i) { return reader.index(i); });
  }

  /// Calls corner(i) for i = 0 .. elements - 1 once each, in order.
  template <typename Corner>
  void addTriangles(uint32_t mode, uint64_t elements, const VertexRange& vertices, const std::string& where,
                    const Corner& corner) {
    const uint64_t count = mode == 4 ? elements / 3 : (elements < 3 ? 0 : elements - 2);
    const auto next = [&](uint64_t i) { return int64_t(corner(i)); };
    uint64_t triangle = 0;
    const SceneBuilder::Place place = [&] { return fmt::format("{}, triangle {}", where, triangle); };
    if (mode == 4) {
      for (; triangle < count; ++triangle) {
        const int64_t a = next(3 * triangle);
        const int64_t b = next(3 * triangle + 1);
        const int64_t c = next(3 * triangle + 2);
        builder_.addPolygon(std::array{a, b, c}, vertices, place);
      }
      return;
    }
    if (count == 0) return;
    const int64_t first = next(0);
    int64_t previous = first;  // corners i and i + 1 of triangle i
    int64_t last = next(1);
    for (; triangle < count; ++triangle) {
      const int64_t newest = next(triangle + 2);
      if (mode == 6) {
        builder_.addPolygon(std::array{last, newest, first}, vertices, place);
      } else if (triangle % 2 == 0) {
        builder_.addPolygon(std::array{previous, last, newest}, vertices, place);
      } else {
        builder_.addPolygon(std::array{previous, newest, last}, vertices, place);
      }
      previous = last;
      last = newest;
    }
  }

  void beginObject(const Instance& instance, size_t primitive) {
    const GltfMesh& mesh = document_.meshes[instance.mesh];
    std::string name = cleanName(document_.nodes[instance.node].name);
    const std::string mesh_name = cleanName(mesh.name);
    if (name.empty()) name = fmt::format("node_{}", instance.node);
    if (!mesh_name.empty() && mesh_name != name) name += "/" + mesh_name;
    if (mesh.primitives.size() > 1) name += fmt::format("/{}", primitive);
    builder_.beginObject(name, name);
  }

  const GltfDocument& document_;
  GltfData& data_;
  const std::string& name_;
  SceneBuilder builder_;
  std::map<VertexKey, VertexRange> vertices_;
};

Scene loadDocument(std::string_view json, std::string_view bin, const std::filesystem::path& file,
                   const SceneLoadOptions& options) {
  const std::string name = file.string();
  const GltfDocument document = readGltfDocument(parseJson(json, name), name);
  GltfData data(document, bin, file);
  return GltfLoader(document, data, name, options).load();
}

}  // namespace

Scene loadGltf(FileBytes bytes, const std::filesystem::path& file, const SceneLoadOptions& options) {
  return loadDocument(bytes.view(), {}, file, options);
}

Scene loadGlb(FileBytes bytes, const std::filesystem::path& file, const SceneLoadOptions& options) {
  const Glb glb = splitGlb(bytes.view(), file.string());
  return loadDocument(glb.json, glb.bin, file, options);
}

}  // namespace sightline

// glTF 2.0: container, nodes in the order of the scene's tree, and the triangles of their meshes.
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <set>

#include "core/base/error.h"
#include "core/formats/draco_stream.h"
#include "core/formats/glb.h"
#include "core/formats/gltf_alpha.h"
#include "core/formats/gltf_data.h"
#include "core/formats/gltf_document.h"
#include "core/formats/gltf_tree.h"
#include "core/formats/gltf_vertices.h"
#include "core/formats/json_text.h"
#include "core/formats/load_scene.h"
#include "core/formats/loaders.h"
#include "core/formats/scene_builder.h"

namespace sightline {
namespace {

/// A small file may place a mesh, and a mesh hold an accessor, any number of times. What that may cost is a
/// number of steps for each of the file's bytes: a step makes a vertex or a triangle. (A forest of 5,000
/// trees with 50,000 triangles each takes 300 of them.)
constexpr uint64_t kStepsAByte = 512;
constexpr uint64_t kStepsAnObject = 64;    ///< as long as naming and placing it takes
constexpr uint64_t kNameBytesAStep = 16;   ///< an object's name is memory too
constexpr uint64_t kStepsAnInfluence = 8;  ///< to blend four joints' matrices

glm::dmat4 translation(const glm::dvec3& by) {
  glm::dmat4 matrix(1.0);
  matrix[3] = glm::dvec4(by, 1.0);
  return matrix;
}

class GltfLoader {
 public:
  /// Changes the document: what is compressed gets views of its own.
  GltfLoader(GltfDocument& document, uint64_t file_bytes, GltfData& data, const std::string& name,
             const SceneLoadOptions& options, const GltfWorld& world)
      : document_(document),
        file_bytes_(file_bytes),
        data_(data),
        name_(name),
        opaque_masks_(options.opaque_masks),
        world_(world.parent),
        builder_(options, world.offset),
        vertices_(document, tree_, data, name, builder_),
        alpha_(document, data, name, options, builder_.surfaces()) {
    world_ *= translation(document.center);
    world_[3] -= glm::dvec4(world.offset, 0.0);
  }

  Scene load() {
    tree_ = readTree(document_, data_, name_,
                     {.world = world_, .repair = builder_.repairs(), .instances = [this](uint64_t count) {
                        spend(count * kStepsAnObject);
                      }});
    decodeDracoMeshes();
    reserve();
    for (const GltfInstance& instance : tree_.instances) {
      const GltfMesh& mesh = document_.meshes[instance.mesh];
      for (size_t i = 0; i < mesh.primitives.size(); ++i) addPrimitive(instance, i);
    }
    warn();
    return builder_.finish(name_);
  }

 private:
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

  /// Throws Error when the steps so far are too many for the file.
  void spend(uint64_t steps) {
    steps_ += steps;
    if (steps_ <= kStepsAByte * (file_bytes_ + data_.bytesOfUris())) return;
    throw Error(
        fmt::format("{}: places its meshes so often that it makes too much of {} bytes; write them out",
                    name_, file_bytes_));
  }

  void spendOnObjects() {
    for (const GltfInstance& instance : tree_.instances) {
      const GltfMesh& mesh = document_.meshes[instance.mesh];
      const uint64_t name_bytes = document_.nodes[instance.node].name.size() + mesh.name.size();
      spend(mesh.primitives.size() * (kStepsAnObject + name_bytes / kNameBytesAStep));
    }
  }

  void decodeDracoMeshes() {
    std::vector<bool> done(document_.meshes.size(), false);
    for (const GltfInstance& instance : tree_.instances) {
      if (done[instance.mesh]) continue;
      done[instance.mesh] = true;
      for (size_t i = 0; i < document_.meshes[instance.mesh].primitives.size(); ++i)
        decodeDraco(instance.mesh, i);
    }
  }

  /// Puts what the primitive's stream holds into the place of the accessors that have no data.
  void decodeDraco(size_t mesh, size_t index) {
    const GltfPrimitive& primitive = document_.meshes[mesh].primitives[index];
    if (!primitive.draco) return;
    const std::string place = fmt::format(
        "{}: meshes[{}].primitives[{}].extensions.KHR_draco_mesh_compression", name_, mesh, index);
    if (!primitive.indices) throw Error(fmt::format("{}: the primitive has no indices", place));
    std::vector<size_t> accessors;
    DracoWish wish;
    for (const auto& [accessor, number] : primitive.draco->attributes) {
      const GltfAccessor& its = document_.accessors[accessor];
      if (its.view) continue;  // of a primitive that shares it
      accessors.push_back(accessor);
      wish.attributes.push_back({number, its.component, its.width});
    }
    const bool wants_indices = !document_.accessors[*primitive.indices].view;
    if (accessors.empty() && !wants_indices) return;
    wish.corner_component = document_.accessors[*primitive.indices].component;
    DracoData decoded = sightline::decodeDraco(data_.view(primitive.draco->view), wish, place);
    spend(decoded.points + decoded.corners);
    for (size_t i = 0; i < accessors.size(); ++i) {
      replace(accessors[i], decoded.points, std::move(decoded.attributes[i]));
    }
    if (wants_indices) replace(*primitive.indices, decoded.corners, std::move(decoded.corner_points));
  }

  void replace(size_t accessor, uint64_t count, std::vector<uint8_t> bytes) {
    GltfAccessor& its = document_.accessors[accessor];
    if (its.count != count) ++other_counts_;
    its.view = data_.addView(document_, std::move(bytes));
    its.byte_offset = 0;
    its.count = count;
    its.sparse.reset();
  }

  /// Vertices of masked primitives get places in the mask's image, a list a primitive.
  void spendOnPlaces() {
    for (const GltfMesh& mesh : document_.meshes) {
      for (const GltfPrimitive& primitive : mesh.primitives) {
        if (hasTriangles(primitive) && primitive.mask_uv)
          spend(document_.accessors[*primitive.positions].count);
      }
    }
  }

  /// Of sources that were checked, so that no count is larger than its data allows.
  void spendOnVertices(const std::set<GltfVertexSource>& sources) {
    for (const GltfVertexSource& source : sources) {
      spend(document_.accessors[source.positions].count *
            (1 + source.targets.size() + kStepsAnInfluence * source.joints.size()));
    }
  }

  /// Makes room for everything at once, and refuses what this machine could never hold, or the file does not
  /// stand for.
  void reserve() {
    spendOnObjects();
    uint64_t positions = 0;
    uint64_t triangles = 0;
    std::set<GltfVertexSource> sources;
    std::set<size_t> index_accessors;
    for (const GltfInstance& instance : tree_.instances) {
      for (const GltfPrimitive& primitive : document_.meshes[instance.mesh].primitives) {
        if (!hasTriangles(primitive)) continue;
        triangles += triangleCount(primitive, elementCount(primitive));
        if (primitive.indices) index_accessors.insert(*primitive.indices);
        if (sources.insert(vertices_.source(instance, primitive)).second) {
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
    for (const GltfVertexSource& source : sources) vertices_.check(source);
    for (const size_t accessor : index_accessors) checkIndices(accessor);
    spendOnVertices(sources);
    spendOnPlaces();
    spend(triangles);
    builder_.reserve(positions, triangles);
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

  void addPrimitive(const GltfInstance& instance, size_t index) {
    const GltfPrimitive& primitive = document_.meshes[instance.mesh].primitives[index];
    if (!hasTriangles(primitive)) return;
    beginObject(instance, index);
    const GltfVertexRun& vertices = vertices_.add(vertices_.source(instance, primitive));
    if (document_.nodes[instance.node].skin && primitive.joints.empty()) ++unbound_;
    surface_ = &alpha_.surface(instance.mesh, index);
    builder_.beginSurface(surface_->flags);
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
    const bool alpha = primitive.material.alpha != GltfMaterial::Alpha::kOpaque;
    if (alpha) builder_.countAlpha(added);
    if (primitive.material.alpha == GltfMaterial::Alpha::kMask && opaque_masks_)
      builder_.countOpaqueMasks(added);
    if (primitive.material.glass && !alpha) builder_.countGlass(added);
    if (!primitive.material.double_sided) builder_.countSingleSided(added);
  }

  void addIndexed(const GltfPrimitive& primitive, const GltfVertexRun& vertices, const std::string& place) {
    const size_t index = *primitive.indices;
    GltfReader reader(document_, data_, index, name_);
    const std::string where = fmt::format("{}, indices in accessors[{}]", place, index);
    addTriangles(primitive.mode, reader.count(), vertices, where,
                 [&](uint64_t i) { return reader.index(i); });
  }

  /// Calls corner(i) for i = 0 .. elements - 1 once each, in order. In a mirrored place two corners change
  /// places, so that the front stays the front.
  template <typename Corner>
  void addTriangles(uint32_t mode, uint64_t elements, const GltfVertexRun& vertices, const std::string& where,
                    const Corner& corner) {
    const uint64_t count = mode == 4 ? elements / 3 : (elements < 3 ? 0 : elements - 2);
    const auto next = [&](uint64_t i) { return int64_t(corner(i)); };
    uint64_t triangle = 0;
    const SceneBuilder::Place place = [&] { return fmt::format("{}, triangle {}", where, triangle); };
    const auto add = [&](int64_t a, int64_t b, int64_t c) {
      if (vertices.isMirrored(a)) std::swap(b, c);
      const uint64_t before = builder_.triangleCount();
      builder_.addPolygon(std::array{a, b, c}, vertices.range, place);
      if (surface_->mask && builder_.triangleCount() > before) {
        builder_.surfaceOfLast(alpha_.addTriangle(*surface_, a, b, c));
      }
    };
    if (mode == 4) {
      for (; triangle < count; ++triangle) {
        const int64_t a = next(3 * triangle);
        const int64_t b = next(3 * triangle + 1);
        const int64_t c = next(3 * triangle + 2);
        add(a, b, c);
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
        add(last, newest, first);
      } else if (triangle % 2 == 0) {
        add(previous, last, newest);
      } else {
        add(previous, newest, last);
      }
      previous = last;
      last = newest;
    }
  }

  void beginObject(const GltfInstance& instance, size_t primitive) {
    const GltfMesh& mesh = document_.meshes[instance.mesh];
    std::string name = cleanName(document_.nodes[instance.node].name);
    const std::string mesh_name = cleanName(mesh.name);
    if (name.empty()) name = fmt::format("node_{}", instance.node);
    if (instance.copy) name += fmt::format("#{}", *instance.copy);
    if (!mesh_name.empty() && mesh_name != name) name += "/" + mesh_name;
    if (mesh.primitives.size() > 1) name += fmt::format("/{}", primitive);
    builder_.beginObject(name, name,
                         GltfPart{uint32_t(instance.node), uint32_t(instance.mesh), uint32_t(primitive)});
  }

  void warn() {
    builder_.countHiddenNodes(tree_.hidden_nodes);
    for (const std::string& warning : document_.warnings) builder_.warn(warning);
    for (const std::string& warning : tree_.warnings) builder_.warn(warning);
    if (other_counts_ != 0) {
      builder_.warn(fmt::format("accessors whose count is not that of their Draco stream, which holds: {}",
                                other_counts_));
    }
    if (unbound_ != 0) {
      builder_.warn(fmt::format(
          "primitives of skinned nodes without JOINTS_0 and WEIGHTS_0, left as they are: {}", unbound_));
    }
    if (vertices_.unweighted() != 0) {
      builder_.warn(fmt::format("skinned vertices whose weights are all 0, placed by their first joint: {}",
                                vertices_.unweighted()));
    }
  }

  GltfDocument& document_;
  const uint64_t file_bytes_;
  uint64_t steps_ = 0;
  GltfData& data_;
  const std::string& name_;
  const bool opaque_masks_;
  glm::dmat4 world_;  ///< from the document's space to the scene's
  SceneBuilder builder_;
  GltfTree tree_;
  GltfVertices vertices_;
  GltfAlpha alpha_;
  const GltfSurface* surface_ = nullptr;  ///< of the primitive in work
  uint64_t other_counts_ = 0;             ///< accessors whose Draco stream has another count
  uint64_t unbound_ = 0;                  ///< primitives of skinned nodes without joints
};

}  // namespace

Scene loadGltfDocument(const Glb& chunks, const std::filesystem::path& file, const SceneLoadOptions& options,
                       const GltfWorld& world) {
  const std::string name = file.string();
  uint64_t words = 0;
  GltfDocument document =
      readGltfDocument(parseJsonWithWords(chunks.json, name, words), name, options.ignored_extensions);
  if (words != 0)
    document.warnings.push_back(fmt::format("words in the place of numbers (NaN), not read: {}", words));
  document.warnings.insert(document.warnings.end(), chunks.warnings.begin(), chunks.warnings.end());
  GltfData data(document, chunks.bin, file, options.allow_external);
  return GltfLoader(document, chunks.json.size() + chunks.bin.size(), data, name, options, world).load();
}

Scene loadGltf(std::string_view bytes, const std::filesystem::path& file, const SceneLoadOptions& options,
               const glm::dvec3& offset) {
  return loadGltfDocument({bytes, {}, {}}, file, options, {.offset = offset});
}

Scene loadGlb(std::string_view bytes, const std::filesystem::path& file, const SceneLoadOptions& options,
              const glm::dvec3& offset) {
  return loadGltfDocument(splitGlb(bytes, file.string()), file, options, {.offset = offset});
}

}  // namespace sightline

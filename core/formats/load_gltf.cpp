// glTF 2.0: container, nodes in the order of the scene's tree, and the triangles of their meshes.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
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
#include "core/scene/instances.h"

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
        options_(options),
        world_(world.parent),
        builder_(options, world.offset),
        vertices_(document, tree_, data, name, builder_),
        alpha_(document, data, name, file_bytes, options, builder_.surfaces()) {
    world_ *= translation(document.center);
    world_[3] -= glm::dvec4(world.offset, 0.0);
  }

  Scene load() {
    tree_ = readTree(document_, data_, name_,
                     {.world = world_, .repair = builder_.repairs(), .instances = [this](uint64_t count) {
                        spend(count * kStepsAnObject);
                      }});
    decodeDracoMeshes();
    findMeshes();
    reserve();
    for (const GltfInstance& instance : tree_.instances) {
      if (placeMesh(instance)) continue;
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

  uint64_t elementCount(const GltfPrimitive& primitive) const { return cornerCountOf(document_, primitive); }

  /// A mesh with the morph targets of its nodes, which several of them show.
  struct SharedMesh {
    std::vector<const GltfInstance*> users;
    bool read = false;
    std::optional<uint32_t> number;   ///< in the builder, if it is an instance anywhere
    std::vector<uint64_t> triangles;  ///< of each primitive
    uint64_t repaired = 0;
    Bounds bounds;
  };
  using MeshKey = std::pair<size_t, std::vector<double>>;

  MeshKey keyOf(const GltfInstance& instance) const {
    const auto& weights = document_.nodes[instance.node].weights;
    return {instance.mesh, weights ? *weights : document_.meshes[instance.mesh].weights};
  }

  uint64_t triangleCount(const GltfMesh& mesh) const {
    uint64_t sum = 0;
    for (const GltfPrimitive& primitive : mesh.primitives) {
      sum += triangleCountOf(document_, primitive);
    }
    return sum;
  }

  /// Collects what several nodes show without a skin, where that pays: other scenes are placed in double, as
  /// they are.
  void findMeshes() {
    for (const GltfInstance& instance : tree_.instances) {
      if (!document_.nodes[instance.node].skin) shared_[keyOf(instance)].users.push_back(&instance);
    }
    std::erase_if(shared_, [&](const auto& entry) {
      return entry.second.users.size() < 2 || usesLittleOfItsVertices(document_.meshes[entry.first.first]);
    });
    uint64_t all = 0, repeated = 0;
    for (const GltfInstance& instance : tree_.instances)
      all += triangleCount(document_.meshes[instance.mesh]);
    for (const auto& [key, mesh] : shared_) {
      repeated += (mesh.users.size() - 1) * triangleCount(document_.meshes[key.first]);
    }
    if (!instancesPay(all - repeated, all)) shared_.clear();
  }

  /// Where all meshes of a file share one list of vertices, each would be read through once a mesh.
  bool usesLittleOfItsVertices(const GltfMesh& mesh) const {
    uint64_t vertices = 0, elements = 0;
    for (const GltfPrimitive& primitive : mesh.primitives) {
      if (!hasTriangles(primitive)) continue;
      vertices += document_.accessors[*primitive.positions].count;
      elements += elementCount(primitive);
    }
    return vertices > 8 * elements;
  }

  SharedMesh* sharedMesh(const GltfInstance& instance) {
    if (document_.nodes[instance.node].skin) return nullptr;
    const auto found = shared_.find(keyOf(instance));
    return found == shared_.end() ? nullptr : &found->second;
  }

  Placement placementOf(const GltfInstance& instance) const {
    const glm::dmat4& to_world = instance.to_world;
    const auto column = [&](int i) { return vec4(glm::vec3(to_world[i]), 0.0f); };
    return {column(0), column(1), column(2), column(3)};
  }

  /// The mesh in its own space. Only vertices that its triangles use.
  void readMesh(const GltfInstance& instance, SharedMesh& mesh) {
    mesh.read = true;
    std::vector<MaskedTriangle>& masked = builder_.surfaces().masked;
    const size_t masked_before = masked.size();
    SceneBuilder builder(options_, glm::dvec3(0.0));
    GltfVertices vertices(document_, tree_, data_, name_, builder);
    into_ = &builder;
    from_ = &vertices;
    for (size_t i = 0; i < document_.meshes[instance.mesh].primitives.size(); ++i) {
      const uint64_t before = builder.triangleCount();
      addPrimitive(instance, i);
      mesh.triangles.push_back(builder.triangleCount() - before);
    }
    into_ = &builder_;
    from_ = &vertices_;
    Scene made = usedPart(builder.takeMesh());
    if (made.triangles.empty()) return;
    mesh.repaired = made.repaired_triangles;
    mesh.bounds = sceneBounds(made);
    const auto places = std::ranges::count_if(
        mesh.users, [&](const GltfInstance* user) { return canPlace(placementOf(*user), mesh.bounds); });
    if (places >= 2) {
      mesh.number = builder_.addMesh(std::move(made));
    } else {
      masked.resize(masked_before);
    }
  }

  /// Without the vertices that no triangle uses.
  static Scene usedPart(Scene scene) {
    constexpr uint32_t kUnused = ~0u;
    std::vector<uint32_t> number(scene.positions.size(), kUnused);
    for (const glm::uvec3& t : scene.triangles) number[t.x] = number[t.y] = number[t.z] = 0;
    uint32_t next = 0;
    for (size_t i = 0; i < number.size(); ++i) {
      if (number[i] == kUnused) continue;
      scene.positions[next] = scene.positions[i];
      number[i] = next++;
    }
    scene.positions.resize(next);
    for (glm::uvec3& t : scene.triangles) t = {number[t.x], number[t.y], number[t.z]};
    return scene;
  }

  /// False: the node's mesh is no instance.
  bool placeMesh(const GltfInstance& instance) {
    SharedMesh* const mesh = sharedMesh(instance);
    if (mesh == nullptr) return false;
    if (!mesh->read) readMesh(instance, *mesh);
    const Placement place = placementOf(instance);
    if (!mesh->number || !canPlace(place, mesh->bounds)) return false;
    builder_.place(*mesh->number, place);
    builder_.countRepaired(mesh->repaired);
    for (size_t i = 0; i < mesh->triangles.size(); ++i) {
      if (mesh->triangles[i] == 0) continue;
      beginObject(instance, i);
      builder_.countPlaced(mesh->triangles[i]);
      countKinds(document_.meshes[instance.mesh].primitives[i].material, mesh->triangles[i], builder_);
    }
    return true;
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
    uint64_t triangles = 0, stored = 0;
    std::set<GltfVertexSource> sources;
    std::set<size_t> index_accessors;
    for (const GltfInstance& instance : tree_.instances) {
      for (const GltfPrimitive& primitive : document_.meshes[instance.mesh].primitives) {
        if (!hasTriangles(primitive)) continue;
        triangles += triangleCountOf(document_, primitive);
        if (sharedMesh(instance) == nullptr) stored += triangleCountOf(document_, primitive);
        if (primitive.indices) index_accessors.insert(*primitive.indices);
        if (sources.insert(sourceOf(instance, primitive)).second) {
          positions += document_.accessors[*primitive.positions].count;
        }
        if (positions > kMaxElements || triangles > kMaxElements) {
          throw Error(fmt::format("{}: more than {} vertices or triangles", name_, kMaxElements));
        }
      }
    }
    const uint64_t bytes = (positions + stored) * 12;
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
    builder_.reserve(positions, stored);
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
    if (!indices.view && !indices.sparse) {
      throw Error(fmt::format("{}: accessors[{}]: indices without a bufferView", name_, accessor));
    }
    GltfReader(document_, data_, accessor, name_);
  }

  /// What the primitive's vertices come from; those of shared meshes are in the mesh's own space.
  GltfVertexSource sourceOf(const GltfInstance& instance, const GltfPrimitive& primitive) {
    GltfVertexSource source = vertices_.source(instance, primitive);
    if (into_ != &builder_) source.to_world = GltfVertices::inPlace();
    return source;
  }

  void addPrimitive(const GltfInstance& instance, size_t index) {
    const GltfPrimitive& primitive = document_.meshes[instance.mesh].primitives[index];
    if (!hasTriangles(primitive)) return;
    beginObject(instance, index);
    const GltfVertexRun& vertices = from_->add(sourceOf(instance, primitive));
    if (document_.nodes[instance.node].skin && primitive.joints.empty()) ++unbound_;
    surface_ = &alpha_.surface(instance.mesh, index);
    into_->beginSurface(surface_->flags);
    const uint64_t before = into_->triangleCount();
    const uint64_t elements = elementCount(primitive);
    const std::string place = fmt::format("{}: meshes[{}].primitives[{}]", name_, instance.mesh, index);
    if (primitive.mode == 4 && elements % 3 != 0) {
      if (!into_->repairs()) {
        throw Error(
            fmt::format("{}: {} corners are no multiple of 3; --repair drops the last", place, elements));
      }
      into_->countRepaired(1);
    }
    if (primitive.indices) {
      addIndexed(primitive, vertices, place);
    } else {
      addTriangles(primitive.mode, elements, vertices, place, [](uint64_t i) { return i; });
    }
    countKinds(primitive.material, into_->triangleCount() - before, *into_);
  }

  void countKinds(const GltfMaterial& material, uint64_t triangles, SceneBuilder& builder) const {
    const bool alpha = material.alpha != GltfMaterial::Alpha::kOpaque;
    if (alpha) builder.countAlpha(triangles);
    if (material.alpha == GltfMaterial::Alpha::kMask && options_.opaque_masks)
      builder.countOpaqueMasks(triangles);
    if (material.glass && !alpha) builder.countGlass(triangles);
    if (!material.double_sided) builder.countSingleSided(triangles);
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
    const uint64_t count = triangleCountOf(mode, elements);
    const auto next = [&](uint64_t i) { return int64_t(corner(i)); };
    uint64_t triangle = 0;
    const SceneBuilder::Place place = [&] { return fmt::format("{}, triangle {}", where, triangle); };
    const auto add = [&](int64_t a, int64_t b, int64_t c) {
      if (vertices.isMirrored(a)) std::swap(b, c);
      const uint64_t before = into_->triangleCount();
      into_->addPolygon(std::array{a, b, c}, vertices.range, place);
      if (surface_->mask && into_->triangleCount() > before) {
        into_->surfaceOfLast(alpha_.addTriangle(*surface_, a, b, c));
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
    into_->beginObject(name, name,
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
  SceneLoadOptions options_;
  glm::dmat4 world_;  ///< from the document's space to the scene's
  SceneBuilder builder_;
  GltfTree tree_;
  GltfVertices vertices_;
  GltfAlpha alpha_;
  const GltfSurface* surface_ = nullptr;  ///< of the primitive in work
  std::map<MeshKey, SharedMesh> shared_;
  // Where primitives are added: to the scene, or to a mesh.
  SceneBuilder* into_ = &builder_;
  GltfVertices* from_ = &vertices_;
  uint64_t other_counts_ = 0;  ///< accessors whose Draco stream has another count
  uint64_t unbound_ = 0;       ///< primitives of skinned nodes without joints
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

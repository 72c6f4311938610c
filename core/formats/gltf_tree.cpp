#include "core/formats/gltf_tree.h"

#include <fmt/format.h>

#include <cmath>

#include "core/base/error.h"

namespace sightline {
namespace {

class TreeReader {
 public:
  TreeReader(const GltfDocument& document, GltfData& data, const std::string& file,
             const GltfTreeOptions& options)
      : document_(document), data_(data), file_(file), options_(options) {
    tree_.world = options.world;
    tree_.to_world.resize(document.nodes.size());
    is_coarser_.resize(document.nodes.size());
    for (const GltfNode& node : document.nodes) {
      for (const size_t coarser : node.coarser) is_coarser_[coarser] = true;
    }
  }

  GltfTree read() {
    push(document_.roots, tree_.world, true);
    while (!stack_.empty()) visitSceneNode();
    placeOthers();
    warn();
    return std::move(tree_);
  }

 private:
  struct Visit {
    size_t node;
    glm::dmat4 parent;
    bool visible;
  };

  void push(const std::vector<size_t>& nodes, const glm::dmat4& parent, bool visible) {
    for (size_t i = nodes.size(); i-- > 0;) stack_.push_back({nodes[i], parent, visible});
  }

  Visit pop() {
    const Visit visit = stack_.back();
    stack_.pop_back();
    return visit;
  }

  void visitSceneNode() {
    const Visit visit = pop();
    if (is_coarser_[visit.node]) return;
    if (tree_.to_world[visit.node]) {
      throw Error(fmt::format("{}: nodes[{}]: occurs twice in the scene's tree", file_, visit.node));
    }
    const GltfNode& node = document_.nodes[visit.node];
    const glm::dmat4 to_world = visit.parent * node.local;
    tree_.to_world[visit.node] = to_world;
    const bool visible = visit.visible && node.visible;
    if (!visible) ++tree_.hidden_nodes;
    if (visible) tree_.coarser_nodes += node.coarser.size();
    if (visible && node.mesh) addInstances(visit.node, to_world);
    push(node.children, to_world, visible);
  }

  void addInstances(size_t index, const glm::dmat4& to_world) {
    const GltfNode& node = document_.nodes[index];
    if (!node.instancing || node.skin) {  // a skinned mesh stands where its joints are, however often
      tree_.instances.push_back({index, *node.mesh, to_world, std::nullopt});
      return;
    }
    bool shows = false;
    for (const GltfPrimitive& primitive : document_.meshes[*node.mesh].primitives) {
      shows = shows || (primitive.mode >= 4 && primitive.positions);
    }
    if (!shows) return;  // a million instances of nothing
    const GltfInstancing& instancing = *node.instancing;
    std::optional<GltfReader> translation = reader(index, instancing.translation, "TRANSLATION", 3);
    std::optional<GltfReader> rotation = reader(index, instancing.rotation, "ROTATION", 4);
    std::optional<GltfReader> scale = reader(index, instancing.scale, "SCALE", 3);
    options_.instances(instancing.count);
    for (uint64_t i = 0; i < instancing.count; ++i) {
      const auto read = [i](std::optional<GltfReader>& from, glm::dvec4 value, int width) {
        for (int c = 0; from && c < width; ++c) value[c] = from->component(i, uint32_t(c));
        return value;
      };
      const glm::dvec4 turn = read(rotation, {0, 0, 0, 1}, 4);
      zero_rotations_ += turn == glm::dvec4(0.0) ? 1 : 0;
      const glm::dmat4 place = gltfPlace(glm::dvec3(read(translation, glm::dvec4(0.0), 3)), turn,
                                         glm::dvec3(read(scale, glm::dvec4(1.0), 3)));
      if (!isFinite(place)) {
        dropInstance(index, i);
        continue;
      }
      flat_ += glm::determinant(glm::dmat3(place)) == 0.0 ? 1 : 0;
      tree_.instances.push_back({index, *node.mesh, to_world * place, i});
    }
  }

  std::optional<GltfReader> reader(size_t node, const std::optional<size_t>& accessor, const char* name,
                                   uint32_t width) {
    if (!accessor) return std::nullopt;
    const GltfAccessor& its = document_.accessors[*accessor];
    if (its.width != width || !its.view) {
      throw Error(
          fmt::format("{}: nodes[{}].extensions.EXT_mesh_gpu_instancing.attributes.{}: accessors[{}] "
                      "needs a bufferView and type VEC{}",
                      file_, node, name, *accessor, width));
    }
    return GltfReader(document_, data_, *accessor, file_);
  }

  static bool isFinite(const glm::dmat4& place) {
    for (int i = 0; i < 16; ++i) {
      if (!std::isfinite(place[i / 4][i % 4])) return false;
    }
    return true;
  }

  void dropInstance(size_t node, uint64_t instance) {
    ++dropped_;
    if (options_.repair) return;
    throw Error(fmt::format(
        "{}: nodes[{}].extensions.EXT_mesh_gpu_instancing: the place of instance {} is not finite; "
        "--repair leaves it out",
        file_, node, instance));
  }

  void warn() {
    const auto warn = [&](const char* what, uint64_t count) {
      if (count != 0) tree_.warnings.push_back(fmt::format("{}: {}", what, count));
    };
    warn("invisible nodes (KHR_node_visibility), left out with all below them", tree_.hidden_nodes);
    warn("coarser levels of detail (MSFT_lod), left out", tree_.coarser_nodes);
    warn("instances whose place is not finite, left out", dropped_);
    warn("instances without volume, which cannot be seen (a scale of 0)", flat_);
    warn("instances whose rotation is a quaternion of zeros, not turned", zero_rotations_);
  }

  /// Nodes that the scene does not reach, from those that are no other's child.
  void placeOthers() {
    std::vector<bool> is_child(document_.nodes.size(), false);
    for (const GltfNode& node : document_.nodes) {
      for (const size_t child : node.children) is_child[child] = true;
    }
    for (size_t i = 0; i < document_.nodes.size(); ++i) {
      if (!is_child[i]) stack_.push_back({i, tree_.world, false});
    }
    while (!stack_.empty()) {
      const Visit visit = pop();
      if (tree_.to_world[visit.node]) continue;
      tree_.to_world[visit.node] = visit.parent * document_.nodes[visit.node].local;
      push(document_.nodes[visit.node].children, *tree_.to_world[visit.node], false);
    }
  }

  const GltfDocument& document_;
  GltfData& data_;
  const std::string& file_;
  const GltfTreeOptions& options_;
  std::vector<bool> is_coarser_;
  uint64_t dropped_ = 0, flat_ = 0, zero_rotations_ = 0;
  GltfTree tree_;
  std::vector<Visit> stack_;
};

}  // namespace

GltfTree readTree(const GltfDocument& document, GltfData& data, const std::string& file,
                  const GltfTreeOptions& options) {
  return TreeReader(document, data, file, options).read();
}

}  // namespace sightline

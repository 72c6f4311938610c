#include "core/formats/gltf_tree.h"

#include <fmt/format.h>

#include "core/base/error.h"

namespace sightline {
namespace {

class TreeReader {
 public:
  TreeReader(const GltfDocument& document, const std::string& file) : document_(document), file_(file) {
    tree_.to_world.resize(document.nodes.size());
  }

  GltfTree read() {
    push(document_.roots, glm::dmat4(1.0), true);
    while (!stack_.empty()) visitSceneNode();
    placeOthers();
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
    if (tree_.to_world[visit.node]) {
      throw Error(fmt::format("{}: nodes[{}]: occurs twice in the scene's tree", file_, visit.node));
    }
    const GltfNode& node = document_.nodes[visit.node];
    const glm::dmat4 to_world = visit.parent * node.local;
    tree_.to_world[visit.node] = to_world;
    const bool visible = visit.visible && node.visible;
    if (!visible) ++tree_.hidden_nodes;
    if (visible && node.mesh) tree_.instances.push_back({visit.node, *node.mesh});
    push(node.children, to_world, visible);
  }

  /// Nodes that the scene does not reach, from those that are no other's child.
  void placeOthers() {
    std::vector<bool> is_child(document_.nodes.size(), false);
    for (const GltfNode& node : document_.nodes) {
      for (const size_t child : node.children) is_child[child] = true;
    }
    for (size_t i = 0; i < document_.nodes.size(); ++i) {
      if (!is_child[i]) stack_.push_back({i, glm::dmat4(1.0), false});
    }
    while (!stack_.empty()) {
      const Visit visit = pop();
      if (tree_.to_world[visit.node]) continue;
      tree_.to_world[visit.node] = visit.parent * document_.nodes[visit.node].local;
      push(document_.nodes[visit.node].children, *tree_.to_world[visit.node], false);
    }
  }

  const GltfDocument& document_;
  const std::string& file_;
  GltfTree tree_;
  std::vector<Visit> stack_;
};

}  // namespace

GltfTree readTree(const GltfDocument& document, const std::string& file) {
  return TreeReader(document, file).read();
}

}  // namespace sightline

#include "core/strip/gltf_uses.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "core/base/error.h"
#include "core/base/text.h"

namespace sightline {
namespace {

using nlohmann::json;

/// Extensions of primitives that do not care for the order of triangles and vertices.
constexpr std::array<std::string_view, 3> kOrderFree = {"KHR_materials_variants", "EXT_mesh_features",
                                                        "EXT_structural_metadata"};

const json& memberOf(const json& object, const char* key) {
  static const json none;
  const auto found = object.find(key);
  return found == object.end() ? none : *found;
}

bool dependsOnOrder(const json& primitive) {
  const json& extensions = memberOf(primitive, "extensions");
  for (const auto& [name, value] : extensions.items()) {
    if (std::find(kOrderFree.begin(), kOrderFree.end(), name) == kOrderFree.end()) return true;
  }
  return false;
}

/// The node that a channel of an animation moves, by its target or, of KHR_animation_pointer, by its path.
std::optional<size_t> movedNode(const json& channel) {
  const json& target = memberOf(channel, "target");
  if (const json& node = memberOf(target, "node"); node.is_number_unsigned()) return node.get<size_t>();
  const json& pointer =
      memberOf(memberOf(memberOf(target, "extensions"), "KHR_animation_pointer"), "pointer");
  constexpr std::string_view kNodes = "/nodes/";
  if (!pointer.is_string() || !pointer.get_ref<const std::string&>().starts_with(kNodes)) return std::nullopt;
  const std::string& path = pointer.get_ref<const std::string&>();
  size_t node = 0;
  std::from_chars(path.data() + kNodes.size(), path.data() + path.size(), node);
  return node;
}

/// Nodes that animations move, with all below them.
std::vector<bool> movingNodes(const GltfDocument& document, const json& root) {
  std::vector<bool> moving(document.nodes.size(), false);
  std::vector<size_t> stack;
  for (const json& animation : memberOf(root, "animations")) {
    for (const json& channel : memberOf(animation, "channels")) {
      if (const std::optional<size_t> node = movedNode(channel)) stack.push_back(*node);
    }
  }
  while (!stack.empty()) {
    const size_t node = stack.back();
    stack.pop_back();
    if (node >= moving.size() || moving[node]) continue;
    moving[node] = true;
    stack.insert(stack.end(), document.nodes[node].children.begin(), document.nodes[node].children.end());
  }
  return moving;
}

class Planner {
 public:
  Planner(const GltfDocument& document, const json& root, const StripInput& input, StripReport& report)
      : document_(document), root_(root), input_(input), report_(report) {}

  std::vector<MeshPlan> run() {
    for (const GltfMesh& mesh : document_.meshes) {
      plans_.emplace_back().primitives.resize(mesh.primitives.size());
    }
    markSeen();
    keepUntouchable();
    for (size_t m = 0; m < plans_.size(); ++m) settle(m);
    count();
    return std::move(plans_);
  }

 private:
  /// A primitive that the scene shows may lose triangles: what no use of it sees.
  void markSeen() {
    for (const SceneObject& object : input_.scene.objects) {
      const GltfPart part = object.part.value();
      PrimitivePlan& plan = plans_[part.mesh].primitives[part.primitive];
      const uint64_t triangles =
          triangleCountOf(document_, document_.meshes[part.mesh].primitives[part.primitive]);
      if (triangles != object.triangle_count) unreadable(part, "has other triangles in the scene");
      plan.whole = false;
      plan.kept.resize(triangles, false);
      for (uint32_t t = 0; t < object.triangle_count; ++t) {
        if (input_.seen[object.first_triangle + t]) plan.kept[t] = true;
      }
    }
  }

  [[noreturn]] void unreadable(const GltfPart& part, const char* what) const {
    throw Error(fmt::format("{}: meshes[{}].primitives[{}]: {}", input_.file.string(), part.mesh,
                            part.primitive, what));
  }

  void keepUntouchable() {
    std::vector<bool> shown(document_.nodes.size(), false);
    for (const SceneObject& object : input_.scene.objects) shown[object.part->node] = true;
    const std::vector<bool> moving = movingNodes(document_, root_);
    uint64_t moves = 0, elsewhere = 0, ordered = 0;
    for (size_t n = 0; n < document_.nodes.size(); ++n) {
      const GltfNode& node = document_.nodes[n];
      if (!node.mesh) continue;
      if (node.skin || moving[n] || hasTargets(*node.mesh)) {
        keepMesh(*node.mesh, moves);
      } else if (!shown[n]) {
        keepMesh(*node.mesh, elsewhere);
      }
    }
    const json& meshes = memberOf(root_, "meshes");
    for (size_t m = 0; m < plans_.size(); ++m) {
      if (meshes[m].contains("extensions")) keepMesh(m, ordered);
      for (size_t p = 0; p < plans_[m].primitives.size(); ++p) {
        if (dependsOnOrder(meshes[m]["primitives"][p])) keep(plans_[m].primitives[p], ordered);
      }
    }
    note(moves, "since animations, skins or morph targets move them: what they hide in their rest goes");
    note(elsewhere, "since nodes show them that the scene does not, or hides");
    note(ordered, "since they have extensions, such as compression, that depend on their triangles' order");
  }

  bool hasTargets(size_t mesh) const {
    const std::vector<GltfPrimitive>& primitives = document_.meshes[mesh].primitives;
    return std::any_of(primitives.begin(), primitives.end(),
                       [](const GltfPrimitive& primitive) { return !primitive.targets.empty(); });
  }

  void keepMesh(size_t mesh, uint64_t& count) {
    for (PrimitivePlan& plan : plans_[mesh].primitives) keep(plan, count);
  }

  static void keep(PrimitivePlan& plan, uint64_t& count) {
    if (plan.whole) return;
    plan.whole = true;
    plan.kept.clear();
    ++count;
  }

  void note(uint64_t primitives, const char* why) {
    if (primitives == 0) return;
    report_.notes.push_back(fmt::format("{} whole, {}", counted(primitives, "primitive") + " stay", why));
  }

  void settle(size_t m) {
    MeshPlan& mesh = plans_[m];
    bool any = false;  // left
    for (PrimitivePlan& plan : mesh.primitives) {
      if (!plan.whole) {
        const bool seen = std::find(plan.kept.begin(), plan.kept.end(), true) != plan.kept.end();
        if (!seen && input_.options.keep_objects) plan.kept[0] = true;
        plan.gone = !seen && !input_.options.keep_objects;
        plan.loses = std::find(plan.kept.begin(), plan.kept.end(), false) != plan.kept.end();
      }
      any = any || !plan.gone;
    }
    if (any || mesh.primitives.empty()) return;
    mesh.unshown = true;
  }

  void count() {
    for (const SceneObject& object : input_.scene.objects) {
      const PrimitivePlan& plan = plans_[object.part->mesh].primitives[object.part->primitive];
      report_.objects_gone += plan.gone ? 1 : 0;
      for (uint32_t t = 0; t < object.triangle_count; ++t) report_.kept.push_back(plan.whole || plan.kept[t]);
    }
    for (MeshPlan& mesh : plans_) {
      if (!mesh.unshown) continue;
      PrimitivePlan& first = mesh.primitives[0];
      first.gone = false;
      first.kept[0] = true;
      first.loses = first.kept.size() > 1;
    }
  }

  const GltfDocument& document_;
  const json& root_;
  const StripInput& input_;
  StripReport& report_;
  std::vector<MeshPlan> plans_;
};

}  // namespace

std::vector<MeshPlan> planMeshes(const GltfDocument& document, const json& root, const StripInput& input,
                                 StripReport& report) {
  return Planner(document, root, input, report).run();
}

}  // namespace sightline

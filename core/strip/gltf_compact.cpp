#include "core/strip/gltf_compact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>
#include <set>

namespace sightline {
namespace {

using nlohmann::json;

/// A mesh's primitives; it may have none.
const json& primitivesOf(const json& mesh) {
  static const json none = json::array();
  const auto found = mesh.find("primitives");
  return found == mesh.end() ? none : *found;
}

/// Calls visit(accessor) for each accessor that the primitive's vertices use: attributes, morph targets.
/// Those that the document does not have are left out: the loader has not looked at all of them.
template <typename Visit>
void forVertexAccessors(const json& root, const json& primitive, const Visit& visit) {
  const auto each = [&](const json& attributes) {
    for (const auto& [name, accessor] : attributes.items()) {
      if (accessor.is_number_unsigned() && accessor.template get<size_t>() < root["accessors"].size()) {
        visit(accessor.template get<size_t>());
      }
    }
  };
  if (primitive.contains("attributes")) each(primitive["attributes"]);
  if (!primitive.contains("targets")) return;
  for (const json& target : primitive["targets"]) each(target);
}

/// Counts, by accessor, what uses it but vertices of primitives: indices, animations, skins, instances.
void countOtherUses(const json& value, std::vector<uint64_t>& uses) {
  const auto count = [&](const json& number) {
    if (number.is_number_unsigned() && number.get<size_t>() < uses.size()) ++uses[number.get<size_t>()];
  };
  if (value.is_array()) {
    for (const json& element : value) countOtherUses(element, uses);
  }
  if (!value.is_object()) return;
  for (const auto& [key, member] : value.items()) {
    if (key == "indices" || key == "input" || key == "output" || key == "inverseBindMatrices") count(member);
    if (key == "EXT_mesh_gpu_instancing" && member.contains("attributes")) {
      for (const auto& [name, accessor] : member["attributes"].items()) count(accessor);
    }
    countOtherUses(member, uses);
  }
}

/// Sets of accessors that are joined by primitives.
class AccessorSets {
 public:
  explicit AccessorSets(size_t accessors) : parent_(accessors) {
    std::iota(parent_.begin(), parent_.end(), size_t(0));
  }
  size_t find(size_t accessor) {
    while (parent_[accessor] != accessor) accessor = parent_[accessor] = parent_[parent_[accessor]];
    return accessor;
  }
  void join(size_t a, size_t b) { parent_[std::max(find(a), find(b))] = std::min(find(a), find(b)); }

 private:
  std::vector<size_t> parent_;
};

/// Primitives that share accessors, directly or by others.
struct VertexGroup {
  std::vector<PrimitiveCorners*> primitives;
  std::set<size_t> accessors;
  bool fixed = false;  ///< something about it cannot be changed
};

template <typename T>
std::string numberText(const uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return fmt::format("{}", value);
}

std::string componentText(GltfComponent component, const uint8_t* from) {
  switch (component) {
    case GltfComponent::kByte:
      return numberText<int8_t>(from);
    case GltfComponent::kUnsignedByte:
      return numberText<uint8_t>(from);
    case GltfComponent::kShort:
      return numberText<int16_t>(from);
    case GltfComponent::kUnsignedShort:
      return numberText<uint16_t>(from);
    case GltfComponent::kUnsignedInt:
      return numberText<uint32_t>(from);
    case GltfComponent::kFloat:
      return numberText<float>(from);
  }
  return {};
}

double componentValue(GltfComponent component, const uint8_t* from) {
  const auto as = [&]<typename T>(T value) {
    std::memcpy(&value, from, sizeof(T));
    return double(value);
  };
  switch (component) {
    case GltfComponent::kByte:
      return as(int8_t());
    case GltfComponent::kUnsignedByte:
      return as(uint8_t());
    case GltfComponent::kShort:
      return as(int16_t());
    case GltfComponent::kUnsignedShort:
      return as(uint16_t());
    case GltfComponent::kUnsignedInt:
      return as(uint32_t());
    case GltfComponent::kFloat:
      return as(float());
  }
  return 0;
}

/// Min and max of packed elements, as JSON.
void setBounds(AccessorContent& content, uint32_t width) {
  const uint64_t bytes = gltfComponentBytes(content.component);
  const auto* base = reinterpret_cast<const uint8_t*>(content.bytes.data());
  for (uint32_t c = 0; c < width; ++c) {
    const uint8_t* low = base + c * bytes;
    const uint8_t* high = low;
    for (uint64_t i = 1; i < content.count; ++i) {
      const uint8_t* at = base + i * content.stride + c * bytes;
      if (componentValue(content.component, at) < componentValue(content.component, low)) low = at;
      if (componentValue(content.component, at) > componentValue(content.component, high)) high = at;
    }
    content.low += (c == 0 ? "[" : ",") + componentText(content.component, low);
    content.high += (c == 0 ? "[" : ",") + componentText(content.component, high);
  }
  content.low += "]";
  content.high += "]";
}

class Compactor {
 public:
  Compactor(const GltfDocument& document, const json& root, GltfData& data, GltfPacker& packer,
            const std::string& file)
      : document_(document), root_(root), data_(data), packer_(packer), file_(file) {}

  uint64_t run(std::vector<PrimitiveCorners>& primitives) {
    uint64_t left = 0;
    for (auto& [first, group] : groups(primitives)) {
      if (group.primitives.empty()) continue;
      if (group.fixed || !isPlain(group)) {
        left += group.primitives.size();
      } else {
        compact(group);
      }
    }
    return left;
  }

 private:
  std::map<size_t, VertexGroup> groups(std::vector<PrimitiveCorners>& primitives) {
    AccessorSets sets(root_["accessors"].size());
    for (const json& mesh : root_["meshes"]) {
      for (const json& primitive : primitivesOf(mesh)) {
        std::optional<size_t> first;
        forVertexAccessors(root_, primitive, [&](size_t accessor) {
          sets.join(first.value_or(accessor), accessor);
          first = accessor;
        });
      }
    }
    std::map<std::pair<size_t, size_t>, PrimitiveCorners*> listed;
    for (PrimitiveCorners& primitive : primitives) {
      listed[{primitive.mesh, primitive.primitive}] = &primitive;
    }
    std::map<size_t, VertexGroup> groups;
    for (size_t m = 0; m < root_["meshes"].size(); ++m) {
      const json& list = primitivesOf(root_["meshes"][m]);
      for (size_t p = 0; p < list.size(); ++p) {
        VertexGroup* group = nullptr;
        forVertexAccessors(root_, list[p], [&](size_t accessor) {
          group = &groups[sets.find(accessor)];
          group->accessors.insert(accessor);
        });
        if (group == nullptr) continue;
        const auto found = listed.find({m, p});
        if (found == listed.end()) {
          group->fixed = true;
        } else {
          group->primitives.push_back(found->second);
        }
      }
    }
    return groups;
  }

  bool isPlain(const VertexGroup& group) {
    if (other_uses_.empty()) {
      other_uses_.assign(root_["accessors"].size(), 0);
      countOtherUses(root_, other_uses_);
    }
    const uint64_t count = document_.accessors[*group.accessors.begin()].count;
    return std::all_of(group.accessors.begin(), group.accessors.end(), [&](size_t a) {
      const GltfAccessor& accessor = document_.accessors[a];
      return accessor.count == count && accessor.view && !accessor.sparse &&
             isPlain(document_.views[*accessor.view]) && other_uses_[a] == 0;
    });
  }

  /// Filtered values are not read as they are written.
  static bool isPlain(const GltfBufferView& view) {
    return !view.compression || view.compression->filter == GltfCompression::Filter::kNone;
  }

  void compact(const VertexGroup& group) {
    const uint64_t count = document_.accessors[*group.accessors.begin()].count;
    std::vector<bool> used(count, false);
    for (const PrimitiveCorners* primitive : group.primitives) {
      for (const uint32_t corner : primitive->corners) used[corner] = true;
    }
    std::vector<uint32_t> stays, new_number(count, 0);
    for (uint32_t v = 0; v < count; ++v) {
      new_number[v] = uint32_t(stays.size());
      if (used[v]) stays.push_back(v);
    }
    if (stays.size() == count || stays.empty()) return;
    for (PrimitiveCorners* primitive : group.primitives) {
      for (uint32_t& corner : primitive->corners) corner = new_number[corner];
    }
    for (const size_t accessor : group.accessors) packer_.replace(accessor, pack(accessor, stays));
  }

  AccessorContent pack(size_t a, const std::vector<uint32_t>& vertices) {
    const GltfAccessor& accessor = document_.accessors[a];
    GltfReader(document_, data_, a, file_);  // checks that all elements are there
    const std::span<const uint8_t> view = data_.view(*accessor.view);
    const uint64_t bytes = gltfComponentBytes(accessor.component) * accessor.width;
    const uint64_t given = document_.views[*accessor.view].byte_stride;
    const uint64_t stride = given == 0 ? bytes : given;
    AccessorContent content;
    content.component = accessor.component;
    content.count = vertices.size();
    content.stride = (bytes + 3) / 4 * 4;
    content.bytes.reserve(content.stride * vertices.size());
    for (const uint32_t vertex : vertices) {
      const auto* from = reinterpret_cast<const char*>(view.data() + accessor.byte_offset + vertex * stride);
      content.bytes.append(from, bytes);
      content.bytes.append(content.stride - bytes, '\0');
    }
    const json& object = root_["accessors"][a];
    if (object.contains("min") || object.contains("max")) setBounds(content, accessor.width);
    return content;
  }

  const GltfDocument& document_;
  const json& root_;
  GltfData& data_;
  GltfPacker& packer_;
  const std::string& file_;
  std::vector<uint64_t> other_uses_;
};

}  // namespace

uint64_t compactVertices(const GltfDocument& document, const json& root, GltfData& data,
                         std::vector<PrimitiveCorners>& primitives, GltfPacker& packer,
                         const std::string& file) {
  return Compactor(document, root, data, packer, file).run(primitives);
}

std::vector<size_t> unusedVertexAccessors(const json& root, const std::vector<MeshPlan>& plans) {
  std::set<size_t> gone, stays;
  for (size_t m = 0; m < plans.size(); ++m) {
    for (size_t p = 0; p < plans[m].primitives.size(); ++p) {
      forVertexAccessors(root, root["meshes"][m]["primitives"][p], [&](size_t accessor) {
        (plans[m].primitives[p].gone ? gone : stays).insert(accessor);
      });
    }
  }
  std::vector<uint64_t> other(root["accessors"].size(), 0);
  countOtherUses(root, other);
  std::vector<size_t> unused;
  for (const size_t accessor : gone) {
    if (!stays.contains(accessor) && other[accessor] == 0) unused.push_back(accessor);
  }
  return unused;
}

}  // namespace sightline

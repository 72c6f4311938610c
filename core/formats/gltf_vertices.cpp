// Based on: Khronos Group, glTF 2.0 Specification, 2021, sections 3.7.2.2 (morph targets) and 3.7.3 (skins).
// All in double: the matrices of a skin often take a far place away and put it back.
#include "core/formats/gltf_vertices.h"

#include <fmt/format.h>

#include <bit>
#include <span>

#include "core/base/error.h"

namespace sightline {
namespace {

std::array<uint64_t, 16> bitsOf(const glm::dmat4& matrix) {
  std::array<uint64_t, 16> bits;
  for (int i = 0; i < 16; ++i) bits[size_t(i)] = std::bit_cast<uint64_t>(matrix[i / 4][i % 4]);
  return bits;
}

glm::dmat4 matrixOf(const std::array<uint64_t, 16>& bits) {
  glm::dmat4 matrix;
  for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = std::bit_cast<double>(bits[size_t(i)]);
  return matrix;
}

bool mirrors(const glm::dmat4& to_world) {
  return glm::determinant(glm::dmat3(to_world)) < 0.0;
}

glm::dvec3 readVec3(GltfReader& reader, uint64_t element) {
  return {reader.component(element, 0), reader.component(element, 1), reader.component(element, 2)};
}

}  // namespace

/// The matrices of a skin's joints, and readers of the pairs JOINTS_n, WEIGHTS_n.
struct GltfVertices::Influences {
  std::span<const glm::dmat4> matrices;
  std::vector<std::pair<GltfReader, GltfReader>> sets;
};

GltfVertices::GltfVertices(const GltfDocument& document, const GltfTree& tree, GltfData& data,
                           const std::string& file, SceneBuilder& builder)
    : document_(document), tree_(tree), data_(data), file_(file), builder_(builder) {}

std::array<uint64_t, 16> GltfVertices::inPlace() {
  return bitsOf(glm::dmat4(1.0));
}

GltfVertexSource GltfVertices::source(const GltfInstance& instance, const GltfPrimitive& primitive) const {
  const GltfNode& node = document_.nodes[instance.node];
  GltfVertexSource source;
  source.positions = *primitive.positions;
  const std::vector<double>& weights = node.weights ? *node.weights : document_.meshes[instance.mesh].weights;
  for (size_t i = 0; i < primitive.targets.size() && i < weights.size(); ++i) {
    if (primitive.targets[i] && weights[i] != 0.0)
      source.targets.emplace_back(*primitive.targets[i], std::bit_cast<uint64_t>(weights[i]));
  }
  source.to_world = bitsOf(node.skin ? tree_.world : instance.to_world);
  if (node.skin && !primitive.joints.empty()) {
    source.skin = node.skin;
    source.joints = primitive.joints;
    source.weights = primitive.weights;
  }
  return source;
}

std::string GltfVertices::accessorPlace(size_t accessor) const {
  return fmt::format("{}: accessors[{}]", file_, accessor);
}

void GltfVertices::checkElements(size_t accessor, uint32_t width, const char* what, const char* type) {
  if (document_.accessors[accessor].width != width) {
    throw Error(fmt::format("{}.type: {} need {}", accessorPlace(accessor), what, type));
  }
  GltfReader(document_, data_, accessor, file_);
}

void GltfVertices::checkCount(size_t accessor, size_t positions) const {
  const uint64_t count = document_.accessors[accessor].count, expected = document_.accessors[positions].count;
  if (count == expected) return;
  throw Error(fmt::format("{}.count: {} does not fit the {} positions in accessors[{}]",
                          accessorPlace(accessor), count, expected, positions));
}

void GltfVertices::check(const GltfVertexSource& source) {
  // All zeros, but for sparse ones; nobody writes all zeros, so the data is where an extension has it.
  const GltfAccessor& positions = document_.accessors[source.positions];
  if (!positions.view && !positions.sparse) {
    throw Error(fmt::format("{}: positions without a bufferView", accessorPlace(source.positions)));
  }
  checkElements(source.positions, 3, "positions", "VEC3");
  for (const auto& [accessor, weight] : source.targets) {
    checkCount(accessor, source.positions);
    checkElements(accessor, 3, "positions", "VEC3");
  }
  if (source.skin) checkSkin(source);
}

void GltfVertices::checkSkin(const GltfVertexSource& source) {
  for (const size_t accessor : source.joints) {
    const GltfComponent component = document_.accessors[accessor].component;
    if ((component != GltfComponent::kUnsignedByte && component != GltfComponent::kUnsignedShort) ||
        document_.accessors[accessor].normalized) {
      throw Error(
          fmt::format("{}: joints need componentType 5121 or 5123, not normalized", accessorPlace(accessor)));
    }
    checkCount(accessor, source.positions);
    checkElements(accessor, 4, "joints", "VEC4");
  }
  for (const size_t accessor : source.weights) {
    const GltfComponent component = document_.accessors[accessor].component;
    if (component != GltfComponent::kFloat && component != GltfComponent::kUnsignedByte &&
        component != GltfComponent::kUnsignedShort) {
      throw Error(fmt::format("{}: weights need componentType 5121, 5123 or 5126", accessorPlace(accessor)));
    }
    checkCount(accessor, source.positions);
    checkElements(accessor, 4, "weights", "VEC4");
  }
  jointMatrices(*source.skin);
}

/// From the space of the mesh to the world, by each joint.
const std::vector<glm::dmat4>& GltfVertices::jointMatrices(size_t index) {
  const auto known = joint_matrices_.find(index);
  if (known != joint_matrices_.end()) return known->second;
  const GltfSkin& skin = document_.skins[index];
  std::optional<GltfReader> inverse_bind;
  if (skin.inverse_bind) {
    const GltfAccessor& accessor = document_.accessors[*skin.inverse_bind];
    if (accessor.component != GltfComponent::kFloat || accessor.count < skin.joints.size() ||
        !accessor.view) {
      throw Error(
          fmt::format("{}: inverse bind matrices need a bufferView, componentType 5126 and a count of at "
                      "least {}, one a joint of skins[{}]",
                      accessorPlace(*skin.inverse_bind), skin.joints.size(), index));
    }
    checkElements(*skin.inverse_bind, 16, "inverse bind matrices", "MAT4");
    inverse_bind.emplace(document_, data_, *skin.inverse_bind, file_);
  }
  std::vector<glm::dmat4> matrices;
  for (size_t joint = 0; joint < skin.joints.size(); ++joint) {
    const std::optional<glm::dmat4>& to_world = tree_.to_world[skin.joints[joint]];
    if (!to_world) {
      throw Error(fmt::format("{}: skins[{}].joints[{}]: nodes[{}] is its own ancestor", file_, index, joint,
                              skin.joints[joint]));
    }
    glm::dmat4 from_mesh(1.0);
    for (uint32_t i = 0; inverse_bind && i < 16; ++i)
      from_mesh[int(i / 4)][int(i % 4)] = inverse_bind->component(joint, i);
    matrices.push_back(*to_world * from_mesh);
  }
  return joint_matrices_.emplace(index, std::move(matrices)).first->second;
}

/// The mean of the joints' matrices by the vertex's weights, whatever they add up to: stored as bytes they
/// seldom make
/// 1. Where all are 0, the first joint's.
glm::dmat4 GltfVertices::blend(Influences& influences, const GltfVertexSource& source, uint64_t vertex) {
  const auto matrix = [&](double joint, size_t set) -> const glm::dmat4& {
    if (joint < double(influences.matrices.size())) return influences.matrices[size_t(joint)];
    throw Error(fmt::format("{}, element {}: joint {} is out of range, skins[{}] has {}",
                            accessorPlace(source.joints[set]), vertex, joint, *source.skin,
                            influences.matrices.size()));
  };
  glm::dmat4 sum(0.0);
  double total = 0.0;
  for (size_t set = 0; set < influences.sets.size(); ++set) {
    auto& [joints, weights] = influences.sets[set];
    for (uint32_t i = 0; i < 4; ++i) {
      const double weight = weights.component(vertex, i);
      if (weight == 0.0) continue;  // what stands beside it need not be a joint
      sum += weight * matrix(joints.component(vertex, i), set);
      total += weight;
    }
  }
  if (total != 0.0) return sum / total;
  ++unweighted_;
  return matrix(influences.sets[0].first.component(vertex, 0), 0);
}

const GltfVertexRun& GltfVertices::add(const GltfVertexSource& source) {
  const auto [entry, is_new] = runs_.try_emplace(source);
  GltfVertexRun& run = entry->second;
  if (!is_new) return run;
  GltfReader positions(document_, data_, source.positions, file_);
  std::vector<std::pair<GltfReader, double>> targets;
  for (const auto& [accessor, weight] : source.targets) {
    targets.emplace_back(GltfReader(document_, data_, accessor, file_), std::bit_cast<double>(weight));
  }
  Influences influences;
  if (source.skin) influences.matrices = jointMatrices(*source.skin);
  for (size_t set = 0; set < source.joints.size(); ++set) {
    influences.sets.emplace_back(GltfReader(document_, data_, source.joints[set], file_),
                                 GltfReader(document_, data_, source.weights[set], file_));
  }
  glm::dmat4 to_world = matrixOf(source.to_world);
  const bool identity = !source.skin && to_world == glm::dmat4(1.0);
  run.range = {int64_t(builder_.positionCount()), int64_t(positions.count()), 0};
  run.mirrored = mirrors(to_world);
  for (uint64_t i = 0; i < positions.count(); ++i) {
    glm::dvec3 position = readVec3(positions, i);
    for (auto& [target, weight] : targets) position += weight * readVec3(target, i);
    if (source.skin) {
      to_world = blend(influences, source, i);
      run.mirrored_by_skin.push_back(mirrors(to_world));
    }
    if (!identity) position = glm::dvec3(to_world * glm::dvec4(position, 1.0));  // keeps -0.0 and every bit
    builder_.addPlaced(position,
                       [&] { return fmt::format("{}, element {}", accessorPlace(source.positions), i); });
  }
  return run;
}

}  // namespace sightline

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/glb.h"
#include "core/formats/gltf_data.h"
#include "core/formats/json_text.h"
#include "core/io/base64.h"
#include "core/strip/gltf_compact.h"
#include "core/strip/strip_formats.h"

namespace sightline {
namespace {

using nlohmann::json;

std::string_view trimmedJson(std::string_view text) {
  return text.substr(0, text.find_last_not_of(std::string_view(" \t\r\n\0", 5)) + 1);
}

/// Name of a file as a URI.
std::string uriOf(const std::string& name) {
  std::string uri;
  for (const char c : name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       std::string_view("-._~").find(c) != std::string_view::npos;
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

void appendWord(std::string& bytes, uint64_t value) {
  const auto word = uint32_t(value);
  bytes.append(reinterpret_cast<const char*>(&word), sizeof(word));
}

class GltfStripper {
 public:
  explicit GltfStripper(const StripInput& input)
      : input_(input),
        name_(input.file.string()),
        is_glb_(input.bytes.starts_with("glTF")),
        glb_(is_glb_ ? splitGlb(input.bytes, name_) : Glb{input.bytes, {}, {}}),
        text_(trimmedJson(glb_.json)),
        root_(parseJsonWithWords(text_, name_, words_)),
        document_(readGltfDocument(root_, name_, input.options.ignored_extensions)),
        data_(document_, glb_.bin, input.file, input.options.allow_external),
        edits_(text_),
        packer_(document_, root_, data_, text_, edits_) {}

  Stripped run() {
    plans_ = planMeshes(document_, root_, input_, stripped_.report);
    collectCorners();
    if (input_.options.compact) {
      const uint64_t left = compactVertices(document_, root_, data_, corners_, packer_, name_);
      if (left != 0) {
        stripped_.report.notes.push_back(
            fmt::format("vertices of {} all stay: their accessors are sparse, filtered or have other uses",
                        counted(left, "primitive")));
      }
      for (const size_t accessor : unusedVertexAccessors(root_, plans_)) packer_.drop(accessor);
    }
    writeIndices();
    editMeshes();
    editNodes();
    editBuffers(packer_.finish());
    writeScene();
    return std::move(stripped_);
  }

 private:
  /// Of the primitives that may change; of those that are gone none.
  void collectCorners() {
    for (size_t m = 0; m < plans_.size(); ++m) {
      for (size_t p = 0; p < plans_[m].primitives.size(); ++p) {
        const PrimitivePlan& plan = plans_[m].primitives[p];
        if (plan.whole || (!plan.loses && !input_.options.compact)) continue;
        corners_.push_back({m, p, {}});
        if (!plan.gone) corners_.back().corners = keptCorners(document_.meshes[m].primitives[p], plan);
      }
    }
  }

  /// In the order and orientation of the file.
  std::vector<uint32_t> keptCorners(const GltfPrimitive& primitive, const PrimitivePlan& plan) {
    std::vector<uint32_t> all;
    if (primitive.indices) {
      GltfReader reader(document_, data_, *primitive.indices, name_);
      for (uint64_t i = 0; i < reader.count(); ++i) all.push_back(uint32_t(reader.index(i)));
    } else {
      all.resize(document_.accessors[*primitive.positions].count);
      for (size_t i = 0; i < all.size(); ++i) all[i] = uint32_t(i);
    }
    std::vector<uint32_t> corners;
    for (size_t t = 0; t < plan.kept.size(); ++t) {
      if (!plan.kept[t]) continue;
      if (primitive.mode == 4) {
        corners.insert(corners.end(), {all[3 * t], all[3 * t + 1], all[3 * t + 2]});
      } else if (primitive.mode == 6) {
        corners.insert(corners.end(), {all[t + 1], all[t + 2], all[0]});
      } else if (t % 2 == 0) {
        corners.insert(corners.end(), {all[t], all[t + 1], all[t + 2]});
      } else {
        corners.insert(corners.end(), {all[t], all[t + 2], all[t + 1]});
      }
    }
    return corners;
  }

  /// Two bytes an index where they are enough, else four; as many as before where that is one, or where the
  /// view that it is in is compressed. before: the accessor that it replaces, if it does.
  AccessorContent indexContent(const std::vector<uint32_t>& corners,
                               const std::optional<GltfAccessor>& before) const {
    const uint32_t most = *std::max_element(corners.begin(), corners.end());
    AccessorContent content;
    content.count = corners.size();
    content.component = most < 0xffff ? GltfComponent::kUnsignedShort : GltfComponent::kUnsignedInt;
    if (before && (before->component == GltfComponent::kUnsignedByte ||
                   (before->view && document_.views[*before->view].compression))) {
      content.component = before->component;
    }
    const uint64_t bytes = gltfComponentBytes(content.component);
    content.bytes.resize(bytes * corners.size());
    for (size_t i = 0; i < corners.size(); ++i) std::memcpy(&content.bytes[i * bytes], &corners[i], bytes);
    return content;
  }

  /// Whether the corners are the primitive's vertices one after the other, and it had no indices before.
  bool needsNoIndices(const PrimitiveCorners& changed, const GltfPrimitive& primitive) const {
    if (primitive.indices || primitive.mode != 4) return false;
    for (size_t i = 0; i < changed.corners.size(); ++i) {
      if (changed.corners[i] != i) return false;
    }
    return changed.corners.size() == packer_.countOf(*primitive.positions);
  }

  /// New accessors for the primitives whose triangles or vertices' numbers change. One that they share with
  /// a primitive that does not change stays as it is.
  void writeIndices() {
    std::map<size_t, uint64_t> users;
    for (const GltfMesh& mesh : document_.meshes) {
      for (const GltfPrimitive& primitive : mesh.primitives) {
        if (primitive.indices) ++users[*primitive.indices];
      }
    }
    std::vector<const PrimitiveCorners*> changed;
    for (const PrimitiveCorners& list : corners_) {
      const GltfPrimitive& primitive = document_.meshes[list.mesh].primitives[list.primitive];
      const PrimitivePlan& plan = plans_[list.mesh].primitives[list.primitive];
      if (!plan.loses && list.corners == keptCorners(primitive, plan)) continue;
      if (primitive.indices) --users[*primitive.indices];
      changed.push_back(&list);
    }
    for (const PrimitiveCorners* list : changed) {
      if (!list->corners.empty()) writeIndicesOf(*list, users);
    }
    for (const PrimitiveCorners* list : changed) {  // those that are gone leave theirs to nobody
      const auto& indices = document_.meshes[list->mesh].primitives[list->primitive].indices;
      if (indices && users[*indices]++ == 0) packer_.drop(*indices);
    }
  }

  /// users: of each accessor of indices, those that go on using it.
  void writeIndicesOf(const PrimitiveCorners& list, std::map<size_t, uint64_t>& users) {
    const GltfPrimitive& primitive = document_.meshes[list.mesh].primitives[list.primitive];
    std::map<std::string, std::optional<std::string>>& values = primitive_edits_[{list.mesh, list.primitive}];
    if (primitive.mode != 4) values["mode"] = "4";
    if (needsNoIndices(list, primitive)) return;
    if (primitive.indices && users[*primitive.indices] == 0) {
      packer_.replace(*primitive.indices,
                      indexContent(list.corners, document_.accessors[*primitive.indices]));
      users[*primitive.indices] = 1;
    } else {
      values["indices"] = std::to_string(packer_.add(indexContent(list.corners, {})));
    }
  }

  void editMeshes() {
    const auto list = jsonMember(text_, jsonRoot(text_), "meshes");
    const std::vector<JsonSpan> meshes = jsonElements(text_, list.value());
    for (size_t m = 0; m < plans_.size(); ++m) {
      if (plans_[m].primitives.empty()) continue;
      const JsonSpan primitives = jsonMember(text_, meshes[m], "primitives").value();
      const std::vector<JsonSpan> spans = jsonElements(text_, primitives);
      std::vector<size_t> gone;
      for (size_t p = 0; p < spans.size(); ++p) {
        if (plans_[m].primitives[p].gone) gone.push_back(p);
        const auto values = primitive_edits_.find({m, p});
        if (values != primitive_edits_.end() && !values->second.empty()) {
          edits_.setMembers(spans[p], values->second);
        }
      }
      if (!gone.empty()) edits_.remove(primitives, gone);
    }
  }

  /// Nodes show no mesh of which nothing is left.
  void editNodes() {
    const auto list = jsonMember(text_, jsonRoot(text_), "nodes");
    const std::vector<JsonSpan> spans = jsonElements(text_, list.value());
    for (size_t n = 0; n < document_.nodes.size(); ++n) {
      const auto& mesh = document_.nodes[n].mesh;
      if (!mesh || !plans_[*mesh].unshown) continue;
      std::map<std::string, std::optional<std::string>> values = {{"mesh", std::nullopt},
                                                                  {"weights", std::nullopt}};
      if (const auto extensions = jsonMember(text_, spans[n], "extensions")) {
        constexpr const char* kInstances = "EXT_mesh_gpu_instancing";  // of a mesh
        const bool has = jsonMember(text_, *extensions, kInstances).has_value();
        if (has && jsonMembers(text_, *extensions).size() == 1) {
          values["extensions"] = std::nullopt;
        } else if (has) {
          edits_.setMembers(*extensions, {{kInstances, std::nullopt}});
        }
      }
      edits_.setMembers(spans[n], values);
    }
  }

  /// The file that a changed buffer goes to: OUT.bin, OUT-1.bin, ...
  std::filesystem::path nextBuffer() {
    std::filesystem::path path = input_.out;
    const std::string stem = input_.out.stem().string();
    do {
      path.replace_filename(stem + (next_buffer_ == 0 ? "" : fmt::format("-{}", next_buffer_)) + ".bin");
      ++next_buffer_;
    } while (isRead(path));
    return path;
  }

  /// Whether it is one of the files beside the scene.
  bool isRead(const std::filesystem::path& path) const {
    for (const GltfBuffer& buffer : document_.buffers) {
      if (!buffer.uri || buffer.uri->starts_with("data:")) continue;
      std::error_code ignored;
      for (const std::string& uri : {*buffer.uri, percentDecoded(*buffer.uri)}) {
        const std::filesystem::path read = input_.file.parent_path() / uri;
        if (std::filesystem::equivalent(read, path, ignored) ||
            read.lexically_normal() == path.lexically_normal()) {
          return true;
        }
      }
    }
    return false;
  }

  void editBuffers(const std::vector<ChangedBuffer>& changed) {
    const auto list = jsonMember(text_, jsonRoot(text_), "buffers");
    if (!list) return;
    const std::vector<JsonSpan> spans = jsonElements(text_, *list);
    std::error_code ignored;
    const std::filesystem::path from = std::filesystem::absolute(input_.file).parent_path();
    const std::filesystem::path to = std::filesystem::absolute(input_.out).parent_path();
    const bool elsewhere = !std::filesystem::equivalent(from, to, ignored);
    bin_ = std::string(glb_.bin);
    for (size_t b = 0; b < document_.buffers.size(); ++b) {
      const GltfBuffer& buffer = document_.buffers[b];
      const auto found = std::find_if(changed.begin(), changed.end(),
                                      [&](const ChangedBuffer& change) { return change.buffer == b; });
      const bool beside = buffer.uri && !buffer.uri->starts_with("data:");
      if (beside) stripped_.report.bytes_before += data_.buffer(b).size();
      if (found == changed.end() && !(beside && elsewhere)) {
        if (beside) stripped_.report.bytes += data_.buffer(b).size();
        continue;
      }
      const std::string bytes = found != changed.end() ? found->bytes : bytesOf(b);
      std::map<std::string, std::optional<std::string>> values = {
          {"byteLength", std::to_string(bytes.size())}};
      if (beside) {
        const std::filesystem::path path = nextBuffer();
        stripped_.report.bytes += bytes.size();
        stripped_.files.push_back({path, bytes});
        values["uri"] = json(uriOf(path.filename().string())).dump();
      } else if (buffer.uri) {
        const std::string head = buffer.uri->substr(0, buffer.uri->find(',') + 1);
        const auto* first = reinterpret_cast<const uint8_t*>(bytes.data());
        values["uri"] = json(head + encodeBase64({first, bytes.size()})).dump();
      } else {
        bin_ = bytes;
      }
      edits_.setMembers(spans[b], values);
    }
    if (elsewhere) notePictures();
  }

  std::string bytesOf(size_t buffer) {
    const std::span<const uint8_t> bytes = data_.buffer(buffer);
    return {bytes.begin(), bytes.end()};
  }

  void notePictures() {
    uint64_t beside = 0;
    if (root_.contains("images")) {
      for (const json& image : root_["images"]) {
        const auto uri = image.find("uri");
        beside +=
            uri != image.end() && uri->is_string() && uri->get<std::string>().find("data:") != 0 ? 1 : 0;
      }
    }
    if (beside == 0) return;
    stripped_.report.notes.push_back(fmt::format(
        "{} that the scene names lie beside it: copy them beside the output", counted(beside, "picture")));
  }

  void writeScene() {
    std::string text = edits_.apply();
    stripped_.report.bytes_before += input_.bytes.size();
    if (is_glb_) text = glbOf(std::move(text));
    stripped_.report.bytes += text.size();
    stripped_.files.push_back({input_.out, std::move(text)});
  }

  std::string glbOf(std::string text) const {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string bin = bin_;
    bin.resize((bin.size() + 3) / 4 * 4, '\0');
    std::string glb = "glTF";
    appendWord(glb, 2);
    appendWord(glb, 12 + 8 + text.size() + (bin.empty() ? 0 : 8 + bin.size()));
    appendWord(glb, text.size());
    glb.append("JSON").append(text);
    if (bin.empty()) return glb;
    appendWord(glb, bin.size());
    return glb.append("BIN\0", 4).append(bin);
  }

  const StripInput& input_;
  const std::string name_;
  const bool is_glb_;
  const Glb glb_;
  const std::string_view text_;
  uint64_t words_ = 0;  ///< in the place of numbers: what does not change keeps them
  json root_;
  const GltfDocument document_;
  GltfData data_;
  JsonEdits edits_;
  GltfPacker packer_;
  Stripped stripped_;
  std::vector<MeshPlan> plans_;
  std::vector<PrimitiveCorners> corners_;
  std::map<std::pair<size_t, size_t>, std::map<std::string, std::optional<std::string>>> primitive_edits_;
  uint64_t next_buffer_ = 0;
  std::string bin_;
};

}  // namespace

Stripped stripGltf(const StripInput& input) {
  return GltfStripper(input).run();
}

}  // namespace sightline

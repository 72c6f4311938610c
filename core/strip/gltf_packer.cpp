#include "core/strip/gltf_packer.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.h"

namespace sightline {
namespace {

using nlohmann::json;

/// What is cut out of a buffer is a multiple of this, so that nothing behind loses its alignment.
constexpr uint64_t kCutAlignment = 16;

constexpr int kVertexTarget = 34962, kIndexTarget = 34963;

/// Counts the uses of buffer views: all members of that name, wherever they stand, and those of property
/// tables, which are named otherwise.
void countViewUses(const json& value, std::vector<uint64_t>& uses) {
  const auto count = [&](const json& number) {
    if (number.is_number_unsigned() && number.get<size_t>() < uses.size()) ++uses[number.get<size_t>()];
  };
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      if (key == "bufferView" || key == "values" || key == "arrayOffsets" || key == "stringOffsets") {
        count(member);
      }
      countViewUses(member, uses);
    }
  } else if (value.is_array()) {
    for (const json& element : value) countViewUses(element, uses);
  }
}

void pad(std::string& bytes, size_t alignment) {
  bytes.resize((bytes.size() + alignment - 1) / alignment * alignment, '\0');
}

using Ranges = std::vector<std::pair<uint64_t, uint64_t>>;

/// The same bytes in ranges that are ascending and apart.
Ranges merged(Ranges ranges) {
  std::sort(ranges.begin(), ranges.end());
  Ranges result;
  for (const auto& [begin, end] : ranges) {
    if (result.empty() || begin > result.back().second) {
      result.emplace_back(begin, end);
    } else {
      result.back().second = std::max(result.back().second, end);
    }
  }
  return result;
}

/// What of `from` is in none of `without`.
Ranges difference(const Ranges& from, const Ranges& without) {
  const Ranges holes = merged(without);
  Ranges result;
  for (auto [begin, end] : merged(from)) {
    for (const auto& [hole, hole_end] : holes) {
      if (hole_end <= begin || hole >= end) continue;
      if (hole > begin) result.emplace_back(begin, hole);
      begin = std::min(hole_end, end);
    }
    if (begin < end) result.emplace_back(begin, end);
  }
  return result;
}

}  // namespace

GltfPacker::GltfPacker(const GltfDocument& document, const json& root, GltfData& data, std::string_view text,
                       JsonEdits& edits)
    : document_(document),
      root_(root),
      data_(data),
      text_(text),
      edits_(edits),
      accessors_(root.contains("accessors") ? root["accessors"].size() : 0) {}

void GltfPacker::replace(size_t accessor, AccessorContent content) {
  contents_[accessor] = std::move(content);
}

uint64_t GltfPacker::countOf(size_t accessor) const {
  const auto replaced = contents_.find(accessor);
  return replaced == contents_.end() ? document_.accessors[accessor].count : replaced->second.count;
}

void GltfPacker::drop(size_t accessor) {
  dropped_.insert(accessor);
}

size_t GltfPacker::add(AccessorContent content) {
  contents_[accessors_] = std::move(content);
  return accessors_++;
}

bool GltfPacker::hasBytes(size_t buffer) const {
  const json& object = root_["buffers"][buffer];
  if (object.contains("uri")) return true;
  const auto extensions = object.find("extensions");  // a place holder of compressed views has none
  return buffer == 0 && (extensions == object.end() || (!extensions->contains("EXT_meshopt_compression") &&
                                                        !extensions->contains("KHR_meshopt_compression")));
}

/// Counts who uses which view, and decides what becomes of each.
void GltfPacker::decideFates() {
  const size_t views = root_.contains("bufferViews") ? root_["bufferViews"].size() : 0;
  fates_.assign(views, Fate::kStays);
  accessors_of_.assign(views, {});
  std::vector<uint64_t> uses(views, 0), released(views, 0);
  countViewUses(root_, uses);
  for (size_t a = 0; a < root_["accessors"].size(); ++a) {
    if (contents_.contains(a) || dropped_.contains(a)) countViewUses(root_["accessors"][a], released);
    const GltfAccessor& accessor = document_.accessors[a];
    if (accessor.view && *accessor.view < views) accessors_of_[*accessor.view].push_back(a);
  }
  for (size_t v = 0; v < views; ++v) {
    if (released[v] == 0) continue;
    std::vector<size_t>& accessors = accessors_of_[v];
    std::stable_sort(accessors.begin(), accessors.end(), [&](size_t a, size_t b) {
      return document_.accessors[a].byte_offset < document_.accessors[b].byte_offset;
    });
    if (canRebuild(v, accessors, uses[v])) {
      fates_[v] = Fate::kRebuilt;
    } else if (released[v] == uses[v]) {
      fates_[v] = Fate::kFree;
    }
  }
}

/// Whether all of the view is elements of accessors, one accessor behind the other, and each keeps the size
/// of its elements.
bool GltfPacker::canRebuild(size_t v, const std::vector<size_t>& accessors, uint64_t uses) const {
  const GltfBufferView& view = document_.views[v];
  if (accessors.size() != uses) return false;
  const auto& packed = view.compression;
  if (packed ? packed->filter != GltfCompression::Filter::kNone : !hasBytes(view.buffer)) return false;
  const uint64_t stride = packed ? packed->byte_stride : view.byte_stride;
  const bool any =
      std::any_of(accessors.begin(), accessors.end(), [&](size_t a) { return !dropped_.contains(a); });
  return any && std::all_of(accessors.begin(), accessors.end(), [&](size_t a) {
           const GltfAccessor& accessor = document_.accessors[a];
           const uint64_t bytes = gltfComponentBytes(accessor.component) * accessor.width;
           if (accessor.sparse || (stride != 0 && accessor.byte_offset % stride != 0)) return false;
           const auto content = contents_.find(a);
           if (content == contents_.end()) return true;
           if (content->second.stride != 0) return content->second.stride == (stride == 0 ? bytes : stride);
           return stride == 0 || gltfComponentBytes(content->second.component) == stride;
         });
}

/// Puts bytes behind the buffer and returns where they are then.
uint64_t GltfPacker::append(size_t buffer, std::string_view bytes) {
  const uint64_t start = data_.buffer(buffer).size() - cutBefore(buffer, ~0ull);
  std::string& tail = tails_[buffer];
  tail.resize((start + tail.size() + 3) / 4 * 4 - start, '\0');
  const uint64_t offset = start + tail.size();
  tail += bytes;
  return offset;
}

void GltfPacker::rebuild(size_t v) {
  const GltfBufferView& view = document_.views[v];
  const std::span<const uint8_t> old = data_.view(v);
  const auto& packed = view.compression;
  const uint64_t stride = packed ? packed->byte_stride : view.byte_stride;
  std::string bytes;
  std::map<std::pair<uint64_t, uint64_t>, uint64_t> copied;  // accessors may share their bytes
  for (const size_t a : accessors_of_[v]) {
    if (dropped_.contains(a)) continue;
    if (!packed && stride == 0) pad(bytes, 4);
    const auto content = contents_.find(a);
    if (content != contents_.end()) {
      place_[a] = {v, bytes.size()};
      bytes += content->second.bytes;
      continue;
    }
    const GltfAccessor& accessor = document_.accessors[a];
    const uint64_t element = gltfComponentBytes(accessor.component) * accessor.width;
    const uint64_t begin = std::min<uint64_t>(accessor.byte_offset, old.size());
    const uint64_t length =
        std::min<uint64_t>(accessor.count * std::max(stride, element), old.size() - begin);
    const auto [known, is_new] = copied.try_emplace({begin, length}, bytes.size());
    place_[a] = {v, known->second};
    if (!is_new) continue;
    bytes.append(reinterpret_cast<const char*>(old.data()) + begin, length);
    if (stride != 0) pad(bytes, stride);  // the last element may end short
  }
  const auto list = jsonMember(text_, jsonRoot(text_), "bufferViews");
  const JsonSpan span = jsonElements(text_, list.value())[v];
  if (!packed) {
    edits_.setMembers(span, {{"byteOffset", std::to_string(append(view.buffer, bytes))},
                             {"byteLength", std::to_string(bytes.size())}});
    return;
  }
  const std::string stream = compressedStream(*packed, bytes).value();
  edits_.setMembers(span, {{"byteLength", std::to_string(bytes.size())}});
  for (const JsonMember& extension : jsonMembers(text_, jsonMember(text_, span, "extensions").value())) {
    if (!extension.key.ends_with("_meshopt_compression")) continue;
    edits_.setMembers(extension.value, {{"byteOffset", std::to_string(append(packed->buffer, stream))},
                                        {"byteLength", std::to_string(stream.size())},
                                        {"count", std::to_string(bytes.size() / stride)}});
  }
}

/// One view for all indices, and one for all vertices of a stride: in the places of free ones, or behind.
void GltfPacker::placeOthers() {
  std::map<uint64_t, std::vector<size_t>> by_stride;
  for (const auto& [accessor, content] : contents_) {
    if (!place_.contains(accessor)) by_stride[content.stride].push_back(accessor);
  }
  if (by_stride.empty()) return;
  size_t home = 0;
  while (home < root_["buffers"].size() && !hasBytes(home)) ++home;
  if (home == root_["buffers"].size()) throw Error("no buffer of the glTF file has bytes");
  size_t slot = 0;
  for (const auto& [stride, accessors] : by_stride) {
    while (slot < fates_.size() && fates_[slot] != Fate::kFree) ++slot;
    std::string bytes;
    for (const size_t accessor : accessors) {
      pad(bytes, 4);
      place_[accessor] = {slot, bytes.size()};
      bytes += contents_[accessor].bytes;
    }
    json view = {{"buffer", home}, {"byteOffset", append(home, bytes)}, {"byteLength", bytes.size()}};
    if (stride != 0) view["byteStride"] = stride;
    view["target"] = stride == 0 ? kIndexTarget : kVertexTarget;
    new_views_[slot++] = view.dump();
  }
}

void GltfPacker::editAccessors() {
  const auto list = jsonMember(text_, jsonRoot(text_), "accessors");
  std::vector<JsonSpan> spans;
  if (list) spans = jsonElements(text_, *list);
  std::vector<std::string> added;
  using Values = std::map<std::string, std::optional<std::string>>;
  for (const auto& [accessor, place] : place_) {
    Values values = {{"bufferView", std::to_string(place.first)},
                     {"byteOffset", std::to_string(place.second)}};
    if (const auto found = contents_.find(accessor); found != contents_.end()) {
      const AccessorContent& content = found->second;
      values["componentType"] = std::to_string(int(content.component));
      values["count"] = std::to_string(content.count);
      values["min"] = content.low.empty() ? std::nullopt : std::optional(content.low);
      values["max"] = content.high.empty() ? std::nullopt : std::optional(content.high);
      values["sparse"] = std::nullopt;
    }
    if (accessor < spans.size()) {
      edits_.setMembers(spans[accessor], values);
      continue;
    }
    json object = {{"type", "SCALAR"}};
    for (const auto& [key, value] : values) {
      if (value) object[key] = json::parse(*value);
    }
    added.push_back(object.dump());
  }
  for (const size_t accessor : dropped_) {
    edits_.setMembers(spans[accessor], Values{{"bufferView", std::nullopt},
                                              {"byteOffset", std::nullopt},
                                              {"count", "1"},
                                              {"min", std::nullopt},
                                              {"max", std::nullopt},
                                              {"sparse", std::nullopt}});
  }
  if (!added.empty()) edits_.append(list.value(), added);
}

/// How many bytes go from the buffer before the offset.
uint64_t GltfPacker::cutBefore(size_t buffer, uint64_t offset) const {
  uint64_t bytes = 0;
  const auto cuts = cuts_.find(buffer);
  if (cuts == cuts_.end()) return 0;
  for (const auto& [begin, end] : cuts->second) {
    if (begin < offset) bytes += end - begin;
  }
  return bytes;
}

/// What views that do not stay leave free, where no view that stays lies.
void GltfPacker::planCuts() {
  std::map<size_t, Ranges> free, live;
  for (size_t v = 0; v < fates_.size(); ++v) {
    const GltfBufferView& view = document_.views[v];
    auto& ranges = fates_[v] == Fate::kStays ? live : free;
    ranges[view.buffer].emplace_back(view.byte_offset, view.byte_offset + view.byte_length);
    if (const auto& packed = view.compression) {
      ranges[packed->buffer].emplace_back(packed->byte_offset, packed->byte_offset + packed->byte_length);
    }
  }
  for (const auto& [buffer, ranges] : free) {
    if (!hasBytes(buffer)) continue;
    const uint64_t size = data_.buffer(buffer).size();
    uint64_t left = size;
    for (auto [begin, end] : difference(ranges, live[buffer])) {
      end = std::min(end, size);
      if (begin >= end) continue;
      uint64_t bytes = (end - begin) / kCutAlignment * kCutAlignment;
      if (end == size && end - begin >= kCutAlignment) bytes = end - begin;  // nothing is behind
      if (bytes == left) bytes -= std::min(bytes, kCutAlignment);            // a buffer must not be empty
      if (bytes == 0) continue;
      cuts_[buffer].emplace_back(begin, begin + bytes);
      left -= bytes;
    }
  }
}

void GltfPacker::editViews() {
  const auto list = jsonMember(text_, jsonRoot(text_), "bufferViews");
  std::vector<JsonSpan> spans;
  if (list) spans = jsonElements(text_, *list);
  for (size_t v = 0; v < spans.size(); ++v) {
    if (fates_[v] == Fate::kRebuilt) continue;
    if (const auto made = new_views_.find(v); made != new_views_.end()) {
      edits_.replace(spans[v], made->second);
      continue;
    }
    const GltfBufferView& view = document_.views[v];
    if (fates_[v] == Fate::kFree) {
      edits_.replace(spans[v], json{{"buffer", view.buffer}, {"byteLength", 1}}.dump());
      continue;
    }
    if (const uint64_t cut = cutBefore(view.buffer, view.byte_offset); cut != 0) {
      edits_.setMembers(spans[v], {{"byteOffset", std::to_string(view.byte_offset - cut)}});
    }
    if (!view.compression) continue;
    const uint64_t cut = cutBefore(view.compression->buffer, view.compression->byte_offset);
    if (cut == 0) continue;
    const JsonSpan extensions = jsonMember(text_, spans[v], "extensions").value();
    for (const JsonMember& extension : jsonMembers(text_, extensions)) {
      if (!extension.key.ends_with("_meshopt_compression")) continue;
      edits_.setMembers(extension.value,
                        {{"byteOffset", std::to_string(view.compression->byte_offset - cut)}});
    }
  }
  std::vector<std::string> added;
  for (const auto& [view, made] : new_views_) {
    if (view >= spans.size()) added.push_back(made);
  }
  if (!added.empty()) edits_.append(list.value(), added);
}

std::vector<ChangedBuffer> GltfPacker::finish() {
  if (contents_.empty() && dropped_.empty()) return {};
  decideFates();
  planCuts();
  for (size_t v = 0; v < fates_.size(); ++v) {
    if (fates_[v] == Fate::kRebuilt) rebuild(v);
  }
  placeOthers();
  editAccessors();
  editViews();
  std::vector<ChangedBuffer> changed;
  for (size_t b = 0; b < document_.buffers.size(); ++b) {
    if (!cuts_.contains(b) && !tails_.contains(b)) continue;
    const std::span<const uint8_t> bytes = data_.buffer(b);
    const std::string_view old(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::string made;
    uint64_t at = 0;
    for (const auto& [begin, end] : cuts_[b]) {
      made += old.substr(at, begin - at);
      at = end;
    }
    made += old.substr(at);
    made += tails_[b];
    changed.push_back({b, std::move(made)});
  }
  return changed;
}

}  // namespace sightline

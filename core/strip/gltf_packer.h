#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/formats/gltf_data.h"
#include "core/formats/gltf_document.h"
#include "core/formats/json_edit.h"

namespace sightline {

/// What an accessor is to hold.
struct AccessorContent {
  GltfComponent component = GltfComponent::kUnsignedInt;
  std::string type = "SCALAR";
  uint64_t count = 0;
  std::string bytes;      ///< of the elements, `stride` apart, or without gaps
  uint64_t stride = 0;    ///< of vertices; 0: indices
  std::string low, high;  ///< JSON of min and max; empty: none
};

/// A buffer that changes.
struct ChangedBuffer {
  size_t buffer = 0;
  std::string bytes;
};

/// Gives accessors of a glTF document new contents: puts those behind one of the buffers, takes what nobody
/// uses any more out of them, and changes the document's text to fit. Numbers of accessors and buffer views
/// stay.
class GltfPacker {
 public:
  /// All must outlive it.
  GltfPacker(const GltfDocument& document, const nlohmann::json& root, GltfData& data, std::string_view text,
             JsonEdits& edits);

  void replace(size_t accessor, AccessorContent content);
  /// How many elements it has, after replace.
  uint64_t countOf(size_t accessor) const;
  /// Nobody uses it any more.
  void drop(size_t accessor);
  /// Returns the number of the new accessor.
  size_t add(AccessorContent content);

  /// Makes the edits of accessors and buffer views; those of the buffers are up to the caller, who says what
  /// became of each.
  std::vector<ChangedBuffer> finish();

 private:
  /// What becomes of a buffer view.
  enum class Fate {
    kStays,    ///< perhaps at another place
    kRebuilt,  ///< with the new contents of its accessors beside the old ones
    kFree,     ///< nobody uses it any more: another may take its number
  };

  bool hasBytes(size_t buffer) const;
  void decideFates();
  bool canRebuild(size_t view, const std::vector<size_t>& accessors, uint64_t uses) const;
  uint64_t append(size_t buffer, std::string_view bytes);
  void rebuild(size_t view);
  void placeOthers();
  void editAccessors();
  void editViews();
  uint64_t cutBefore(size_t buffer, uint64_t offset) const;
  void planCuts();

  const GltfDocument& document_;
  const nlohmann::json& root_;
  GltfData& data_;
  std::string_view text_;
  JsonEdits& edits_;
  std::map<size_t, AccessorContent> contents_;
  std::set<size_t> dropped_;
  size_t accessors_;                                     ///< with those added
  std::vector<Fate> fates_;                              ///< by view
  std::vector<std::vector<size_t>> accessors_of_;        ///< by view, by offset
  std::map<size_t, std::pair<size_t, uint64_t>> place_;  ///< view and offset, by accessor
  std::map<size_t, std::string> new_views_;              ///< JSON, in the place of free ones or behind all
  std::map<size_t, std::string> tails_;                  ///< by buffer: what is put behind it
  std::map<size_t, std::vector<std::pair<uint64_t, uint64_t>>> cuts_;  ///< by buffer: from, to; ascending
};

/// The stream of EXT_meshopt_compression with these values, `stride` bytes each, or nothing if the mode does
/// not take them.
std::optional<std::string> compressedStream(const GltfCompression& like, std::string_view values);

}  // namespace sightline

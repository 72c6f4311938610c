#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/formats/gltf_document.h"

namespace sightline {

/// The bytes behind a glTF document: finds buffers (GLB chunk, data URI, file beside), decompresses buffer
/// views and checks every range before anything is read. Loads each buffer and view when first asked for.
/// A buffer may be shorter than it claims, where no view needs the rest.
class GltfData {
 public:
  /// `bin` is the GLB's second chunk, or empty; it must outlive the object. `file` is the document's own.
  /// allow_external: SceneLoadOptions.
  GltfData(const GltfDocument& document, std::string_view bin, const std::filesystem::path& file,
           bool allow_external = false);

  /// Bytes of a buffer view, decompressed. Throws Error.
  std::span<const uint8_t> view(size_t index);

  /// Adds a view of these bytes to the document, which must be the one that this was made with.
  size_t addView(GltfDocument& document, std::vector<uint8_t> bytes);

  /// Bytes of a buffer: those that the document claims, or fewer, if there are fewer. Throws Error.
  std::span<const uint8_t> buffer(size_t index);

  /// Bytes that a uri names, in it or in a file beside the document. place: of the uri. Throws Error.
  std::vector<uint8_t> resource(const std::string& uri, const std::string& place) const;

  /// Of the buffers loaded so far that are not the GLB's chunk.
  uint64_t bytesOfUris() const;

 private:
  std::span<const uint8_t> part(size_t buffer, uint64_t offset, uint64_t length, const std::string& place);
  std::vector<uint8_t> decompress(const GltfCompression& compression, uint64_t byte_length,
                                  const std::string& place);

  struct Bytes {
    bool loaded = false;
    std::vector<uint8_t> own;
    std::span<const uint8_t> data;
  };

  const GltfDocument& document_;
  std::span<const uint8_t> bin_;
  std::filesystem::path file_;
  bool allow_external_;
  std::vector<Bytes> buffers_;
  std::vector<Bytes> views_;
};

/// Reads an accessor's elements in order, each as `width` numbers; sparse values replace those below them.
class GltfReader {
 public:
  /// Throws Error unless every element lies in its buffer view. `place` names the accessor in messages.
  GltfReader(const GltfDocument& document, GltfData& data, size_t accessor, const std::string& file);

  uint64_t count() const { return accessor_.count; }
  /// Component `c` of element `i`; i must not descend from call to call.
  double component(uint64_t i, uint32_t c);
  /// The same as a whole number, for index accessors.
  uint64_t index(uint64_t i);

 private:
  const uint8_t* element(uint64_t i);

  GltfAccessor accessor_;
  const uint8_t* base_ = nullptr;  ///< null: zeros
  uint64_t stride_ = 0;
  std::vector<uint64_t> sparse_indices_;
  const uint8_t* sparse_values_ = nullptr;
  uint64_t element_bytes_ = 0;
  size_t next_sparse_ = 0;
};

/// A URI with %20 and the like decoded; a % before anything else than two digits stands for itself.
std::string percentDecoded(const std::string& uri);

/// Bytes of one component.
uint64_t gltfComponentBytes(GltfComponent component);

}  // namespace sightline

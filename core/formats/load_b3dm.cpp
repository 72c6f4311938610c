// Based on: Cesium, 3D Tiles Specification 1.0, 2019, "Batched 3D Model". Its glTF has y up, its tile z up.
#include <fmt/format.h>

#include <array>
#include <cstring>

#include "core/base/error.h"
#include "core/formats/glb.h"
#include "core/formats/json_object.h"
#include "core/formats/json_text.h"
#include "core/formats/little_word.h"
#include "core/formats/loaders.h"

namespace sightline {
namespace {

/// The tables before the glTF.
enum Table { kFeatureJson, kFeatureBinary, kBatchJson, kBatchBinary, kTables };
constexpr size_t kTileHeaderBytes = 28;

/// Where the header has the tables' lengths, and where it ends. Before version 1.0 of the specification it
/// was shorter, and had no feature table; what stands in the place of a length is text then, '"' at least.
struct TileHeader {
  std::array<size_t, kTables> lengths;  ///< 0: there is none
  size_t bytes;
};
constexpr uint32_t kText = 0x22000000;

TileHeader headerOf(std::string_view bytes) {
  if (littleWord(bytes, 20) >= kText) return {{0, 0, 16, 0}, 20};
  if (littleWord(bytes, 24) >= kText) return {{0, 0, 12, 16}, 24};
  return {{12, 16, 20, 24}, kTileHeaderBytes};
}

struct Tile {
  std::array<std::string_view, kTables> tables;
  std::string_view glb;
};

Tile splitTile(std::string_view bytes, const std::string& name) {
  if (bytes.size() < kTileHeaderBytes) throw Error(fmt::format("{}: the tile's header is cut off", name));
  if (littleWord(bytes, 4) != 1) {
    throw Error(fmt::format("{}: b3dm version {}, only 1 is supported", name, littleWord(bytes, 4)));
  }
  if (littleWord(bytes, 8) > bytes.size()) {
    throw Error(fmt::format("{}: the header says {} bytes, the file has {}; is it truncated?", name,
                            littleWord(bytes, 8), bytes.size()));
  }
  Tile tile;
  const TileHeader header = headerOf(bytes);
  size_t offset = header.bytes;
  for (size_t i = 0; i < kTables; ++i) {
    const size_t length = header.lengths[i] == 0 ? 0 : littleWord(bytes, header.lengths[i]);
    if (length > bytes.size() - offset) {
      throw Error(fmt::format("{}: a table of {} bytes at byte {} is cut off after {}", name, length, offset,
                              bytes.size() - offset));
    }
    tile.tables[i] = bytes.substr(offset, length);
    offset += length;
  }
  tile.glb = bytes.substr(offset);
  return tile;
}

/// RTC_CENTER: numbers, or three floats in the binary table.
glm::dvec3 centerOf(const Tile& tile, const std::string& name) {
  if (tile.tables[kFeatureJson].find_first_not_of(" \t\r\n") == std::string_view::npos)
    return glm::dvec3(0.0);
  const std::string file = name + ": feature table";
  const nlohmann::json document = parseJson(tile.tables[kFeatureJson], file);
  const JsonObject table(document, file, "");
  if (!table.has("RTC_CENTER")) return glm::dvec3(0.0);
  if (!document["RTC_CENTER"].is_object()) {
    const std::vector<double> center = *table.numbers("RTC_CENTER", 3);
    return {center[0], center[1], center[2]};
  }
  const uint64_t at = table.requiredObject("RTC_CENTER").requiredNumber("byteOffset");
  const std::string_view binary = tile.tables[kFeatureBinary];
  glm::vec3 center;
  if (at > binary.size() || binary.size() - at < sizeof(center)) {
    table.fail("RTC_CENTER.byteOffset", "lies outside of the binary table");
  }
  std::memcpy(&center, binary.data() + at, sizeof(center));
  return glm::dvec3(center);
}

}  // namespace

Scene loadB3dm(std::string_view bytes, const std::filesystem::path& file, const SceneLoadOptions& options,
               const glm::dvec3& offset) {
  const std::string name = file.string();
  const Tile tile = splitTile(bytes, name);
  const glm::dvec3 center = centerOf(tile, name);
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(center[axis])) throw Error(fmt::format("{}: RTC_CENTER is not finite", name));
  }
  const glm::dmat4 to_tile(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 0, 1, 0), glm::dvec4(0, -1, 0, 0),
                           glm::dvec4(center, 1));
  return loadGltfDocument(splitGlb(tile.glb, name), file, options, {.parent = to_tile, .offset = offset});
}

}  // namespace sightline

#include "core/strip/strip_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "core/base/error.h"
#include "core/formats/scene_format.h"
#include "core/formats/utf16.h"
#include "core/io/file_io.h"
#include "core/strip/strip_formats.h"

namespace sightline {
namespace {

/// Throws Error where files of the kind are not written.
SceneFormat writtenFormat(std::string_view bytes, const std::filesystem::path& file) {
  if (fromUtf16(bytes)) {
    throw Error(fmt::format("{}: is UTF-16, which is not written; save it as UTF-8 first", file.string()));
  }
  const SceneFormat format = formatOf(bytes, file);
  if (format == SceneFormat::kB3dm) {
    throw Error(
        fmt::format("{}: is a 3D Tile, which is not written; take the glTF out of it first", file.string()));
  }
  return format;
}

Stripped strip(const StripInput& input) {
  switch (writtenFormat(input.bytes, input.file)) {
    case SceneFormat::kObj:
      return stripObj(input);
    case SceneFormat::kGltf:
    case SceneFormat::kGlb:
      return stripGltf(input);
    case SceneFormat::kPly:
      return stripPly(input);
    case SceneFormat::kB3dm:
      break;
  }
  throw std::logic_error("a kind of scene file that is not written");
}

void refuseOtherKind(const std::filesystem::path& file, const std::filesystem::path& out) {
  const std::string extension = lowerExtension(file);
  if (lowerExtension(out) == extension) return;
  throw Error(fmt::format("{}: must end with {}, as the scene does: a stripped scene stays of its kind",
                          out.string(), extension),
              kExitUsage);
}

}  // namespace

void requireStrippable(const std::filesystem::path& file, const std::filesystem::path& out) {
  refuseOtherKind(file, out);
  const FileBytes bytes = readFile(file);
  writtenFormat(bytes.view(), file);
}

std::vector<bool> keptFaces(const StripInput& input, StripReport& report) {
  const std::vector<uint32_t>& faces = input.scene.faces;
  std::vector<bool> kept(faces.empty() ? 0 : faces.back() + size_t(1), false);
  for (size_t id = 0; id < faces.size(); ++id) {
    if (input.seen[id]) kept[faces[id]] = true;
  }
  for (const SceneObject& object : input.scene.objects) {
    const auto first = faces.begin() + object.first_triangle;
    const bool any =
        std::any_of(first, first + object.triangle_count, [&](uint32_t face) { return kept[face]; });
    if (any) continue;
    if (input.options.keep_objects) {
      kept[*first] = true;
    } else {
      ++report.objects_gone;
    }
  }
  for (const uint32_t face : faces) report.kept.push_back(kept[face]);
  return kept;
}

StripReport stripScene(const Scene& scene, const std::filesystem::path& file, const std::vector<bool>& seen,
                       const StripOptions& options, const std::filesystem::path& out) {
  refuseOtherKind(file, out);
  if (std::find(seen.begin(), seen.end(), true) == seen.end()) {
    throw Error(fmt::format("{}: no triangle of it is seen, so nothing would be left; check the cells",
                            file.string()));
  }
  const FileBytes bytes = readFile(file);
  Stripped stripped = strip({bytes.view(), file, scene, seen, options, out});
  std::vector<bool>& kept = stripped.report.kept;
  stripped.report.triangles = uint64_t(std::count(kept.begin(), kept.end(), true));
  for (size_t i = 0; i + 1 < stripped.files.size(); ++i) {
    const std::filesystem::path& buffer = stripped.files[i].path;
    std::error_code ignored;
    if (std::filesystem::exists(buffer, ignored) && !options.overwrite) {
      throw Error(
          fmt::format("{}: is there already, a buffer of {} would replace it; name another output, "
                      "or --overwrite it",
                      buffer.string(), out.string()));
    }
    stripped.report.buffers.push_back(buffer);
  }
  for (const StrippedFile& made : stripped.files) saveText(made.bytes, made.path);
  return stripped.report;
}

}  // namespace sightline

#include "core/formats/scene_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/base/error.h"
#include "core/io/file_io.h"

namespace sightline {
namespace {

using namespace std::string_view_literals;

/// Starts of files, with what they are and the remedy.
struct Magic {
  std::string_view start, what;
};

constexpr std::string_view kCoff =
    "is an object file of a compiler (COFF), not Wavefront OBJ; export the scene under another name";
constexpr std::string_view kTile =
    "is a 3D Tile of a kind that is not read; only b3dm is, or convert it to glTF";

constexpr std::array kForeign = {
    Magic{"\x1f\x8b"sv, "is packed by gzip; unpack it (gunzip)"},
    Magic{"PK\x03\x04"sv, "is a ZIP archive; unpack it and give the scene in it"},
    Magic{"7z\xbc\xaf\x27\x1c"sv, "is a 7z archive; unpack it and give the scene in it"},
    Magic{"\x28\xb5\x2f\xfd"sv, "is packed by zstd; unpack it (unzstd)"},
    Magic{"\xfd"
          "7zXZ\0"sv,
          "is packed by xz; unpack it (unxz)"},
    Magic{"BZh"sv, "is packed by bzip2; unpack it (bunzip2)"},
    Magic{"\x64\x86"sv, kCoff},      // x86-64
    Magic{"\x4c\x01"sv, kCoff},      // x86
    Magic{"\x64\xaa"sv, kCoff},      // ARM64
    Magic{"\xc4\x01"sv, kCoff},      // ARM
    Magic{"\0\0\xff\xff"sv, kCoff},  // of link-time code, or with many sections
    Magic{"\x7f"
          "ELF"sv,
          "is a program or library (ELF), not a scene"},
    Magic{"version https://git-lfs"sv,
          "is a pointer of Git LFS, not the scene itself; fetch that (git lfs pull)"},
    Magic{"/annex/objects/"sv, "is a pointer of git-annex, not the scene itself; fetch that (git annex get)"},
    Magic{"i3dm"sv, kTile},
    Magic{"pnts"sv, kTile},
    Magic{"cmpt"sv, kTile},
    Magic{"DRACO"sv, "is a bare Draco stream; put it into glTF (KHR_draco_mesh_compression)"},
    Magic{"Kaydara FBX Binary"sv, "is FBX, which is not read; export or convert it to glTF"},
    Magic{"BLENDER"sv, "is a Blender file; export glTF from it"},
    Magic{"PXR-USDC"sv, "is USD, which is not read; export or convert it to glTF"},
    Magic{"#usda"sv, "is USD, which is not read; export or convert it to glTF"},
    Magic{"\x89PNG"sv, "is a picture (PNG), not a scene"},
    Magic{"\xff\xd8\xff"sv, "is a picture (JPEG), not a scene"},
    Magic{"\xff\xfe\0\0"sv, "is text in UTF-32; save it as UTF-8"},
};

std::string_view withoutBlanks(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text;
}

bool startsWithWord(std::string_view text, std::string_view lower) {
  if (text.size() < lower.size()) return false;
  for (size_t i = 0; i < lower.size(); ++i) {
    const char c = text[i];
    if ((c >= 'A' && c <= 'Z' ? char(c + 'a' - 'A') : c) != lower[i]) return false;
  }
  return true;
}

}  // namespace

std::optional<SceneFormat> formatOfContent(std::string_view bytes) {
  if (bytes.starts_with("glTF")) return SceneFormat::kGlb;
  if (bytes.starts_with("b3dm")) return SceneFormat::kB3dm;
  const std::string_view text = withoutBlanks(bytes.substr(0, 4096));
  if (text.starts_with("ply\n") || text.starts_with("ply\r")) return SceneFormat::kPly;
  if (text.starts_with('{')) return SceneFormat::kGltf;
  return std::nullopt;
}

std::optional<SceneFormat> formatOfName(const std::filesystem::path& file) {
  const std::string extension = lowerExtension(file);
  if (extension == ".obj") return SceneFormat::kObj;
  if (extension == ".gltf") return SceneFormat::kGltf;
  if (extension == ".glb") return SceneFormat::kGlb;
  if (extension == ".ply") return SceneFormat::kPly;
  if (extension == ".b3dm") return SceneFormat::kB3dm;
  return std::nullopt;
}

SceneFormat formatOf(std::string_view bytes, const std::filesystem::path& file) {
  if (const auto format = formatOfContent(bytes)) return *format;
  if (const auto format = formatOfName(file)) return *format;
  throw Error(fmt::format("{}: unknown extension \"{}\", expected .obj, .gltf, .glb, .ply or .b3dm",
                          file.string(), lowerExtension(file)));
}

std::string foreignContent(std::string_view bytes) {
  for (const Magic& magic : kForeign) {
    if (bytes.starts_with(magic.start)) return std::string(magic.what);
  }
  const std::string_view text = withoutBlanks(bytes.substr(0, 4096));
  if (startsWithWord(text, "<!doctype html") || startsWithWord(text, "<html")) {
    return "is a web page (HTML), not a scene; a download gave the page about the file, or an error: fetch "
           "the file itself";
  }
  if (startsWithWord(text, "<?xml") || startsWithWord(text, "<collada")) {
    return "is XML (Collada, X3D or another), which is not read; export or convert it to glTF";
  }
  return {};
}

}  // namespace sightline

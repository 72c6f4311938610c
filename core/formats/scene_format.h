#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace sightline {

/// Formats that loadScene reads.
enum class SceneFormat { kObj, kGltf, kGlb, kPly, kB3dm };

/// The format that the first bytes show, whatever the file's name; nothing where they show none. (An OBJ
/// shows nothing: any text may be one.)
std::optional<SceneFormat> formatOfContent(std::string_view bytes);

/// The format that the extension stands for, in any case.
std::optional<SceneFormat> formatOfName(const std::filesystem::path& file);

/// That of a file that is read: by content, else by name. Throws Error where neither says.
SceneFormat formatOf(std::string_view bytes, const std::filesystem::path& file);

/// What the bytes are if they hold no scene that is read, whatever the file's name, and what to do: "is
/// packed by gzip; unpack it (gunzip)". Empty: nothing of the sort.
std::string foreignContent(std::string_view bytes);

}  // namespace sightline

#include "core/io/beside.h"

namespace sightline {

std::optional<std::filesystem::path> besideScene(const std::filesystem::path& scene,
                                                 const std::string& name) {
  const std::filesystem::path relative = std::filesystem::path(name).lexically_normal();
  if (relative.is_absolute() || (!relative.empty() && *relative.begin() == "..")) return std::nullopt;
  return scene.parent_path() / relative;
}

}  // namespace sightline

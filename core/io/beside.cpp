#include "core/io/beside.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;

bool climbsOut(const fs::path& relative) {
  return relative.is_absolute() || (!relative.empty() && *relative.begin() == "..");
}

/// Whether links lead from the folder to a place outside of it. False for what cannot be looked at: then it
/// cannot be read either.
bool linksLeadOut(const fs::path& folder, const fs::path& file) {
  std::error_code problem;
  const fs::path real_folder = fs::weakly_canonical(folder, problem);
  if (problem) return false;
  const fs::path real_file = fs::weakly_canonical(file, problem);
  return !problem && climbsOut(real_file.lexically_relative(real_folder));
}

}  // namespace

std::optional<fs::path> besideScene(const fs::path& scene, const std::string& name, bool allow_external) {
  const fs::path relative = fs::path(name).lexically_normal();
  if (allow_external) return scene.parent_path() / relative;  // an absolute name stands for itself
  if (climbsOut(relative)) return std::nullopt;
  const fs::path folder = scene.parent_path().empty() ? fs::path(".") : scene.parent_path();
  if (linksLeadOut(folder, folder / relative)) return std::nullopt;
  return scene.parent_path() / relative;
}

}  // namespace sightline

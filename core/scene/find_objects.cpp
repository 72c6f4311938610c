#include "core/scene/find_objects.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/base/glob.h"
#include "core/base/nearest.h"

namespace sightline {
namespace {

/// Names that an error lists where none is near.
constexpr size_t kListedNames = 8;

bool isOf(const std::string& name, const std::string& pattern) {
  if (matchesGlob(name, pattern)) return true;
  for (size_t slash = name.find('/'); slash != std::string::npos; slash = name.find('/', slash + 1)) {
    if (matchesGlob(std::string_view(name).substr(0, slash), pattern)) return true;
  }
  return false;
}

/// Throws what there is to say about a pattern that no object is of.
[[noreturn]] void failOn(const Scene& scene, const std::string& pattern, const std::string& option) {
  std::vector<std::string> names;
  for (const SceneObject& object : scene.objects) {
    if (std::find(names.begin(), names.end(), object.name) == names.end()) names.push_back(object.name);
  }
  std::string word = pattern;
  std::erase_if(word, [](char c) { return c == '*' || c == '?'; });
  std::string hint = didYouMean(word, names);
  if (hint.empty() && !names.empty()) {
    const size_t listed = std::min(kListedNames, names.size());
    hint = fmt::format("; there are {}{}", fmt::join(names.begin(), names.begin() + ptrdiff_t(listed), ", "),
                       names.size() > listed ? fmt::format(", and {} more", names.size() - listed) : "");
  }
  throw Error(fmt::format("{}: no object of the scene is named {}{}", option, pattern, hint), kExitUsage);
}

}  // namespace

std::vector<NamedTriangles> findObjects(const Scene& scene, std::span<const std::string> patterns,
                                        const std::string& option) {
  std::vector<bool> chosen(scene.objects.size(), false);
  for (const std::string& pattern : patterns) {
    bool any = false;
    for (size_t i = 0; i < scene.objects.size(); ++i) {
      if (!isOf(scene.objects[i].name, pattern)) continue;
      chosen[i] = any = true;
    }
    if (!any) failOn(scene, pattern, option);
  }
  std::vector<NamedTriangles> found;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    if (chosen[i]) found.push_back({object.name, object.first_triangle, object.triangle_count});
  }
  return found;
}

}  // namespace sightline

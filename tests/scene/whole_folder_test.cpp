// How many scene files of a folder load: SIGHTLINE_SCENES=FOLDER test_scene --gtest_filter='WholeFolder.*'
// The folder is not part of the project, and holds none of those files that validators must refuse. Files
// that are not whole (cut off, or without a file that they need) or hold no triangles do not count; of the
// others 98 % must load.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "core/base/error.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;

constexpr double kShare = 0.98;

std::vector<fs::path> sceneFiles(const fs::path& folder) {
  constexpr std::array<std::string_view, 6> kExtensions = {".obj", ".gltf", ".glb", ".ply", ".b3dm", ".vrm"};
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = lowerExtension(entry.path());
    const bool scene = std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
    if (scene && entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Whether what is wrong is the file's: it is cut off or damaged, lacks a file that it needs, holds no
/// triangles, or is of another format than its name says.
bool isNoWholeScene(const fs::path& file, const std::string& error) {
  constexpr std::array<std::string_view, 10> kWords = {
      "truncated?", "cut off",      "cannot open",  "is missing",          "holds no triangles",
      "is empty",   "is packed by", "only glTF 2;", "only 2 is supported", "does not fit the"};
  const auto in_error = [&](std::string_view word) { return error.find(word) != std::string::npos; };
  if (std::any_of(kWords.begin(), kWords.end(), in_error)) return true;
  try {
    loadScene(file, {.repair = true});
    return true;
  } catch (const Error& repaired) {
    return std::string_view(repaired.what()).find("no triangle is left") != std::string_view::npos;
  }
}

TEST(WholeFolder, NearlyAllScenesLoad) {
  const char* folder = std::getenv("SIGHTLINE_SCENES");
  if (folder == nullptr) GTEST_SKIP() << "SIGHTLINE_SCENES names no folder of scenes";
  size_t loaded = 0, broken = 0, refused = 0;
  for (const fs::path& file : sceneFiles(folder)) {
    try {
      loadScene(file);
      ++loaded;
    } catch (const Error& error) {
      const bool no_scene = isNoWholeScene(file, error.what());
      ++(no_scene ? broken : refused);
      fmt::print("{}: {}\n", no_scene ? "not whole, or without triangles" : "REFUSED", error.what());
    }
  }
  const size_t whole = loaded + refused;
  ASSERT_GT(whole, 0u) << folder << " holds no scenes";
  fmt::print(
      "{}: {} of {} whole files with triangles load ({:.1f} %); {} others are not whole or hold none\n",
      folder, loaded, whole, 100.0 * double(loaded) / double(whole), broken);
  EXPECT_GE(double(loaded), kShare * double(whole));
}

}  // namespace
}  // namespace sightline

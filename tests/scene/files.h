#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/formats/load_scene.h"
#include "core/scene/scene.h"

namespace sightline::test {

/// A folder of its own for a test, removed at its end.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sightline-scene-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
    path_ = pattern;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// Writes a file and returns its path.
  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::remove(file);  // truncating a file instead makes some file systems write it out at once
    std::ofstream stream(file, std::ios::binary);
    stream.write(bytes.data(), std::streamsize(bytes.size()));
    if (!stream) throw std::runtime_error("cannot write " + file.string());
    return file;
  }

 private:
  std::filesystem::path path_;
};

inline std::string readText(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The message of the Error that the call throws, with the folder cut off; fails the test if it throws none,
/// or more than one line.
inline std::string errorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    const size_t folder = message.find("sightline-scene-");
    const size_t slash = folder == std::string::npos ? folder : message.find('/', folder);
    return slash == std::string::npos ? message : message.substr(slash + 1);
  }
  ADD_FAILURE() << "no Error was thrown";
  return {};
}

/// Checks what scene.h promises of every Scene.
inline void expectValid(const Scene& scene) {
  ASSERT_FALSE(scene.triangles.empty());
  for (size_t i = 0; i < scene.positions.size(); ++i) {
    const glm::vec3& p = scene.positions[i];
    ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << "position " << i;
  }
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      ASSERT_LT(scene.triangles[i][corner], scene.positions.size()) << "triangle " << i;
    }
  }
  uint64_t next = 0;
  for (const SceneObject& object : scene.objects) {
    ASSERT_EQ(object.first_triangle, next) << object.name;
    ASSERT_GT(object.triangle_count, 0u) << object.name;
    ASSERT_FALSE(object.name.empty());
    next += object.triangle_count;
  }
  ASSERT_EQ(next, scene.triangles.size());
}

/// Loads text as a file of that name.
inline Scene loadText(const std::string& name, std::string_view text, const SceneLoadOptions& options = {}) {
  const Folder folder;
  return loadScene(folder.write(name, text), options);
}

inline std::string loadError(const std::string& name, std::string_view text,
                             const SceneLoadOptions& options = {}) {
  return errorOf([&] { loadText(name, text, options); });
}

}  // namespace sightline::test

#include "core/formats/save_scene.h"

#include <fmt/format.h>

#include <charconv>
#include <functional>

#include "core/base/error.h"
#include "core/formats/glb_bytes.h"
#include "core/formats/obj_text.h"
#include "core/formats/saved_runs.h"
#include "core/io/file_io.h"
#include "core/scene/instances.h"
#include "core/scene/scene.h"

namespace sightline {
namespace {

using WriteText = std::function<void(std::string_view)>;

/// Collects text and passes it on in large pieces.
class TextWriter {
 public:
  explicit TextWriter(const WriteText& write) : write_(write) {}
  ~TextWriter() = default;
  TextWriter(const TextWriter&) = delete;
  TextWriter& operator=(const TextWriter&) = delete;

  void text(std::string_view value) {
    buffer_.append(value);
    if (buffer_.size() > kPiece) flush();
  }
  /// A blank and the number; floats as the shortest decimal that reads back to the same bits.
  template <typename Number>
  void number(Number value) {
    char digits[32];
    digits[0] = ' ';
    const auto result = std::to_chars(digits + 1, digits + sizeof(digits), value);
    buffer_.append(digits, size_t(result.ptr - digits));
  }
  void flush() {
    write_(buffer_);
    buffer_.clear();
  }

 private:
  static constexpr size_t kPiece = 1 << 20;
  const WriteText& write_;
  std::string buffer_;
};

}  // namespace

void writeObj(const Scene& scene, const std::string& name, const WriteText& write) {
  checkWritable(scene, name);
  if (!scene.surfaces.empty()) {
    throw Error(
        fmt::format("{}: an OBJ holds no masks, glass or sides, which the scene has; write .glb", name),
        kExitUsage);
  }
  TextWriter writer(write);
  if (scene.hasInstances()) return writeObj(flatten(scene), name, write);  // OBJ has none
  for (const glm::vec3& position : scene.positions) {
    writer.text("v");
    for (int i = 0; i < 3; ++i) {
      if (scene.offset[i] == 0.0) {
        writer.number(position[i]);
      } else {
        writer.number(double(position[i]) + scene.offset[i]);
      }
    }
    writer.text("\n");
  }
  for (const SceneObject& object : scene.objects) {
    writer.text("o " + object.name + "\n");
    for (uint32_t i = 0; i < object.triangle_count; ++i) {
      writer.text("f");
      for (int corner = 0; corner < 3; ++corner) {
        writer.number(uint64_t(scene.triangles[object.first_triangle + i][corner]) + 1);
      }
      writer.text("\n");
    }
  }
  writer.flush();
}

void saveGlb(const SceneStream& stream, const std::filesystem::path& file) {
  OutputFile output(file);
  streamGlb(stream, file.string(), [&output](std::string_view piece) { output.write(piece); });
  output.commit();
}

void saveScene(const Scene& scene, const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::string extension = lowerExtension(file);
  if (extension != ".obj" && extension != ".glb") {
    throw Error(fmt::format("{}: unknown extension \"{}\", expected .obj or .glb", name, extension));
  }
  checkWritable(scene, name);
  OutputFile output(file);
  (extension == ".obj" ? writeObj : writeGlb)(scene, name,
                                              [&output](std::string_view piece) { output.write(piece); });
  output.commit();
}

}  // namespace sightline

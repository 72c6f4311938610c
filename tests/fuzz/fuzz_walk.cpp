#include <cmath>

#include "core/formats/walk_file.h"
#include "tests/fuzz/check.h"

namespace sightline::fuzz {
namespace {

void check(std::string_view text) {
  expectLine("w.json", [&] {
    const CameraPath path = parseWalk(text, "w.json");
    require(path.frames() > 0, "no frames");
    for (uint32_t frame = 0; frame < path.frames(); frame += 1 + path.frames() / 1000) {
      const PathPlace at = placeAt(path, frame);
      for (int axis = 0; axis < 3; ++axis) {
        require(std::isfinite(at.eye[axis]) && std::isfinite(at.look[axis]), "a place that is not finite");
      }
      require(at.eye != at.look, "nothing to look at");
    }
    require(parseWalk(walkText(path, "w.json"), "w.json") == path, "another path after writing and reading");
  });
}

}  // namespace
}  // namespace sightline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  sightline::fuzz::check(sightline::fuzz::fileBytes(data, size).view());
  return 0;
}

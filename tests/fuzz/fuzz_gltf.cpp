#include <cstring>

#include "core/formats/loaders.h"
#include "tests/fuzz/check.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const bool glb = size >= 4 && std::memcmp(data, "glTF", 4) == 0;
  sightline::fuzz::checkScene(glb ? sightline::loadGlb : sightline::loadGltf, glb ? ".glb" : ".gltf", data,
                              size);
  return 0;
}

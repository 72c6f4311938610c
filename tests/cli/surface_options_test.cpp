// --opaque-masks and --cull-back-faces, as a user meets them.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_files.h"

namespace sightline {
namespace {

using test::expectRun;

/// A square with a mask whose texture is not there.
std::string maskedFile() {
  test::GltfFile file = test::squareFile<uint8_t>(5121);
  file.document["meshes"][0]["primitives"][0]["material"] = 0;
  file.document["materials"] = {
      {{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  file.document["textures"] = {{{"source", 0}}};
  file.document["images"] = {{{"uri", "leaf.png"}}};
  return file.glb();
}

TEST(SurfaceOptions, TakeAMaskWithoutItsTextureAsOpaque) {
  const test::Folder folder;
  const std::string scene = folder.write("a.glb", maskedFile()).string();
  expectRun("info " + scene, 1, {"images[0].uri", "leaf.png", "--opaque-masks"});
  expectRun("info " + scene + " --opaque-masks", 0, {"alpha            2 triangles"});
}

TEST(SurfaceOptions, CullBackFacesInABakeAndAllThatReadsIt) {
  const test::Folder folder;
  // A wall that shows its back to the cell, before another that shows its front.
  const std::string scene = folder
                                .write("a.obj",
                                       "v -9 -9 0\nv 9 -9 0\nv 0 9 0\nv -9 -9 -5\nv 9 -9 -5\nv 0 9 -5\n"
                                       "f 1 3 2\nf 4 5 6\n")
                                .string();
  const std::string cells =
      folder.write("c.json", R"({"cells":[{"name":"spot","center":[0,0,3],"size":[1,1,1]}]})").string();
  const std::string pvs = (folder / "x.pvs").string(), report = (folder / "r.json").string();
  const std::string bake = "bake " + scene + " --cells " + cells + " -o " + pvs +
                           " --device cpu --n-rand 20000" +
                           " --validation-rays 1000 --witnesses --overwrite --report " + report;
  expectRun(bake, 0, {"1 "});
  const auto read = [&] { return nlohmann::json::parse(test::readText(report)); };
  EXPECT_EQ(read()["scene"]["surfaces"]["front_only_triangles"], 0);
  expectRun(bake + " --cull-back-faces", 0, {});
  EXPECT_EQ(read()["scene"]["surfaces"]["front_only_triangles"], 2);
  expectRun("info " + scene + " --cull-back-faces", 0, {"2 not there from behind"});
  expectRun("verify " + scene + " " + pvs, 1, {"another scene", "--cull-back-faces"});
  expectRun("verify " + scene + " " + pvs + " --cull-back-faces", 0, {});
}

}  // namespace
}  // namespace sightline

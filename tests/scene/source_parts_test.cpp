// Where in its file a triangle comes from: glTF's node, mesh and primitive; OBJ's and PLY's faces.
#include <gtest/gtest.h>

#include "files.h"
#include "gltf_files.h"

namespace sightline {
namespace {

using namespace test;

std::vector<uint32_t> facesOf(const std::string& name, const std::string& text, bool repair = false) {
  return loadText(name, text, {.repair = repair, .faces = true}).faces;
}

using Faces = std::vector<uint32_t>;

TEST(SourceParts, GltfObjectsNameNodeMeshAndPrimitive) {
  GltfFile file = squareFile<uint16_t>(5123);
  json& primitives = file.document["meshes"][0]["primitives"];
  primitives = {primitives[0], {{"attributes", {{"POSITION", 0}}}, {"mode", 1}}, primitives[0]};
  file.document["nodes"] = {{{"children", {2}}}, {{"mesh", 0}}, {{"mesh", 0}}};
  file.document["scenes"] = {{{"nodes", {0, 1}}}};
  const Scene scene = loadText("a.glb", file.glb());
  ASSERT_EQ(scene.objects.size(), 4u);
  const GltfPart expected[] = {{2, 0, 0}, {2, 0, 2}, {1, 0, 0}, {1, 0, 2}};
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(scene.objects[i].part, expected[i]) << i;
}

TEST(SourceParts, OnlyGltfObjectsHaveThem) {
  EXPECT_EQ(loadText("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").objects[0].part, std::nullopt);
}

TEST(SourceParts, ObjTrianglesKnowTheirFace) {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no a\nf 1 2 3 4\ng b\nf 1 2 \\\n 3\nfo 1 2 3\nl 1 2\nf 1 2 3 4\n";
  EXPECT_EQ(facesOf("a.obj", text), (Faces{0, 0, 1, 2, 3, 3}));
  EXPECT_TRUE(loadText("a.obj", text).faces.empty());  // unless they are asked for
}

TEST(SourceParts, FacesBeforeTheirVerticesCountOnce) {
  EXPECT_EQ(facesOf("a.obj", "v 0 0 0\nf 1 1 1\nf 1 2 3\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"), (Faces{0, 1, 2}));
}

TEST(SourceParts, DroppedFacesCountToo) {
  EXPECT_EQ(facesOf("a.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2\nf 1 2 9\nf 1 2 3\n", true),
            (Faces{0, 3}));
}

TEST(SourceParts, PlyTrianglesKnowTheirRow) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\n"
      "element tristrips 2\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n8 0 1 2 3 -1 0 1 2\n3 1 2 3\n";
  EXPECT_EQ(facesOf("a.ply", text), (Faces{0, 0, 1, 2, 3, 4, 5}));
}

}  // namespace
}  // namespace sightline

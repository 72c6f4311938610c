// Voxels of a scene, as a user makes them.
#include <gtest/gtest.h>

#include <fstream>

#include "core/formats/load_scene.h"
#include "core/voxel/voxel_file.h"
#include "tests/cli/run_program.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::expectRun;
using test::Folder;

std::string content(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(VoxelsCommand, WritesVoxelsOnEveryDeviceAlike) {
  const Folder folder;
  const std::string where = (folder / "").string();
  expectRun("scene plant -o " + where + "p.glb --triangles 5000 --seed 3", 0, {});
  expectRun("voxels " + where + "p.glb -o " + where + "a.slv --voxel 0.5", 0,
            {"a.slv: ", " voxels of 0.5 of ", "level", "ids of triangles by block"});
  const VoxelFile file = loadVoxels(where + "a.slv");
  const Scene scene = loadScene(where + "p.glb", {});
  EXPECT_EQ(file.levels.front().blocks, voxelize(scene, {.lattice = latticeOf(0.5)}).blocks);
  requireScene(file.head, scene, where + "a.slv");
  for (const std::string options :
       {"--separate 6", "--separate 26 --attributes normal,object", "--without-triangles --memory 1"}) {
    for (const std::string device : {"cpu", "opencl"}) {
      expectRun("voxels " + where + "p.glb -o " + where + device + ".slv --overwrite --along 100 --device " +
                    device + " " + options,
                0, {});
    }
    EXPECT_EQ(content(where + "cpu.slv"), content(where + "opencl.slv")) << options;
  }
  expectRun("voxels " + where + "p.glb -o " + where + "b.slv --separate 6 --attributes normal", 0,
            {"attributes: "});
  expectRun("info " + where + "b.slv", 0,
            {"those of a 6-separating set", "ids of triangles, normals", "0: ", "format version 1"});
}

TEST(VoxelsCommand, RefusesInOneLine) {
  const Folder folder;
  const std::string where = (folder / "").string();
  const std::string scene = folder.write("t.obj", "v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n").string();
  const std::string voxels = "voxels " + scene + " -o " + where + "t.slv ";
  expectRun(voxels + "--voxel 0.3", 2, {"a voxel of 0.3 is not a power of two: take 0.25 or 0.5"});
  expectRun(voxels + "--voxel nan", 2, {"too small or too large"});
  expectRun(voxels + "--voxel 0.0009765625", 2, {"take 0.00195312 or more"});
  expectRun(voxels + "--voxel 1 --along 7", 2, {"--along"});
  expectRun(voxels + "--device vulkan", 2, {"vulkan does not voxelise: expected cpu, opencl or opencl:N"});
  expectRun(voxels + "--attributes colour", 2, {"colour is none of normal, object"});
  EXPECT_FALSE(std::filesystem::exists(where + "t.slv"));
  expectRun(voxels + "--voxel 1", 0, {});
  expectRun(voxels + "--voxel 1", 1, {"is there already"});
  std::string bytes = content(where + "t.slv");
  bytes[bytes.size() / 2] ^= 1;
  folder.write("damaged.slv", bytes);
  expectRun("info " + where + "damaged.slv", 1, {"damaged.slv: byte ", "checksum is wrong"});
  expectRun("info " + folder.write("no.slv", "nothing").string(), 1, {"no.slv: byte 0: ", "no voxel file"});
}

}  // namespace
}  // namespace sightline

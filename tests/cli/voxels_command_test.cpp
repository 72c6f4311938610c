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
  requireScene(file.head, hashScene(scene), where + "a.slv");
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

TEST(VoxelsCommand, FillsWhatIsSolid) {
  const Folder folder;
  const std::string where = (folder / "").string();
  // A closed box of 12 triangles, 4 voxels a side and half a voxel off the lattice.
  std::string box = "o box\n";
  for (int i = 0; i < 8; ++i) {
    box += std::string("v ") + ((i & 1) != 0 ? "4.5 " : "0.5 ") + ((i & 2) != 0 ? "4.5 " : "0.5 ") +
           ((i & 4) != 0 ? "4.5\n" : "0.5\n");
  }
  box += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n";
  const std::string open = folder.write("open.obj", box).string();
  const std::string closed = folder.write("closed.obj", box + "f 2 4 8 6\n").string();
  const std::string to = " -o " + where + "v.slv --overwrite --voxel 1 --solid ";
  for (const std::string rule : {"parity", "winding", "reach"}) {
    expectRun("voxels " + closed + to + rule + " --closed", 0, {"closed parts: 1 of 1", "125 voxels of 1"});
    EXPECT_EQ(loadVoxels(where + "v.slv").levels.front().count(), 125u) << rule;
    expectRun("voxels " + open + to + rule + " --closed", 1,
              {"box is not closed", "open edge from 4.5,", "closed parts: 0 of 1"});
    // A side of it is missing, and the way in is open.
    expectRun("voxels " + open + to + rule, 0, {"closed parts: 0 of 1; nothing is hidden in solids"});
  }
  expectRun("voxels " + closed + to + "reach --reach 2.5,2.5,2.5", 0, {"100.0 % of space is reached"});
  expectRun("voxels " + closed + to + "reach --reach 0.5,2.5,2.5", 2, {"triangles meet"});
  expectRun("voxels " + closed + to + "parity --separate 6", 2, {"--solid is of conservative voxels"});
  expectRun("voxels " + closed + to + "all", 2, {"all is none of parity, winding, reach"});
}

TEST(VoxelsCommand, RefusesInOneLine) {
  const Folder folder;
  const std::string where = (folder / "").string();
  const std::string scene = folder.write("t.obj", "v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n").string();
  const std::string voxels = "voxels " + scene + " -o " + where + "t.slv ";
  expectRun(voxels + "--voxel 0.3", 2, {"a voxel of 0.3 is not a power of two: take 0.25 or 0.5"});
  expectRun(voxels + "--voxel 0.001", 2, {"take 0.0009765625 or 0.001953125"});  // as can be typed again
  expectRun("voxels " + scene + " --voxel 1 -o -", 2, {"- is standard output, where a voxel file cannot go"});
  expectRun("voxels " + scene + " --voxel 1 -o " + where + "t2.obj", 2, {"t2.obj: must end with .slv"});
  EXPECT_FALSE(std::filesystem::exists(where + "t2.obj"));
  expectRun(voxels + "--voxel 1 --solid parity --reach 1,1,1", 2, {"--reach: is of --solid reach only"});
  expectRun(voxels + "--voxel 1 --solid reach --reach 1,1", 2, {"--reach: '1,1' has 2 numbers"});
  expectRun(voxels + "--voxel nan", 2, {"too small or too large"});
  expectRun(voxels + "--voxel 0.0009765625", 2, {"take 0.001953125 or more"});
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

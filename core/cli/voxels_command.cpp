#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <memory>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/load_options.h"
#include "core/cli/number_checks.h"
#include "core/cli/overwrite.h"
#include "core/cli/share_line.h"
#include "core/cli/stop_signal.h"
#include "core/cli/voxel_options.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "core/voxel/voxel_file.h"
#include "core/voxel/voxelize.h"

namespace sightline {
namespace {

struct VoxelsArguments {
  std::filesystem::path scene, output;
  VoxelSize size;
  uint64_t memory_mib = 1024;
  bool without_triangles = false;
  bool overwrite = false;
  SceneLoadOptions load;
};

void sayLevels(const Lattice& lattice, const std::vector<VoxelLevelCounts>& levels) {
  fmt::print("{:>5}  {:>10}  {:>13}  {:>9}  {:>11}  {:>12}\n", "level", "voxel", "voxels", "blocks", "MiB",
             "bytes/voxel");
  for (size_t level = 0; level < levels.size(); ++level) {
    const VoxelLevelCounts& counts = levels[level];
    fmt::print("{:>5}  {:>10g}  {:>13}  {:>9}  {:>11.3f}  {:>12.2f}\n", level,
               std::ldexp(1.0, lattice.exponent + int(level)), counts.voxels, counts.blocks,
               double(counts.geometry_bytes) / 0x1p20, double(counts.geometry_bytes) / double(counts.voxels));
  }
  if (levels.front().triangle_bytes != 0) {
    fmt::print("ids of triangles by block: {:.3f} MiB\n", double(levels.front().triangle_bytes) / 0x1p20);
  }
}

void run(const VoxelsArguments& arguments) {
  requireSeparate(std::array{arguments.output}, std::array{arguments.scene});
  requireNew(arguments.output, arguments.overwrite);
  const Scene scene = loadScene(arguments.scene, arguments.load);
  const Lattice lattice = arguments.size.of(scene);
  const StopSignal stop;
  ShareLine status("voxelised");
  VoxelWriter writer(arguments.output, headOf(scene, lattice, !arguments.without_triangles));
  const VoxelizeOptions options{
      .lattice = lattice,
      .with_triangles = !arguments.without_triangles,
      .memory = arguments.memory_mib << 20,
      .progress = [&](double done,
                      uint64_t voxels) { status.show(done, [&] { return shortCount(voxels) + " voxels"; }); },
      .stop = stop.flag()};
  try {
    voxelize(scene, options, [&](VoxelBlock&& block) { writer.add(std::move(block)); });
  } catch (const Interrupted&) {
    status.end();
    fmt::print("stopped: nothing is written\n");
    throw ExitCode{stop.exitCode()};
  }
  const std::vector<VoxelLevelCounts> levels = writer.finish();
  status.end();
  fmt::print("{}: {} voxels of {:g} of {}\n", arguments.output.string(), levels.front().voxels,
             lattice.voxelSize(), counted(scene.triangleCount(), "triangle"));
  sayLevels(lattice, levels);
}

constexpr const char* kVoxelsFooter =
    "Every voxel that a triangle meets, and no other: decided exactly, touching counts. A\n"
    "voxel's size is a power of two in the scene's units, and the origin is a corner of\n"
    "voxels. The file holds, for each block of 64 x 64 x 64, the ids of the triangles that\n"
    "meet it, and coarser levels up to the root: a voxel is in one if it has a part in the\n"
    "level below.\n\n"
    "Examples:\n"
    "  sightline voxels city.glb -o city.slv --voxel 0.25\n"
    "  sightline voxels statue.ply -o statue.slv --along 1024\n";

}  // namespace

void addVoxelsCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("voxels", "Say which voxels of a lattice a scene meets");
  const auto a = std::make_shared<VoxelsArguments>();
  command->add_option("SCENE", a->scene, "Scene file: .obj, .gltf, .glb or .ply")->required();
  command->add_option("-o,--output", a->output, "Voxel file to write (.slv)")->required();
  a->size.declare(*command);
  command
      ->add_option("--memory", a->memory_mib,
                   "MiB for lists of triangles, beside the scene: with fewer, more passes")
      ->transform(wholeNumber(1, 1 << 20))
      ->type_name("MIB")
      ->capture_default_str();
  command->add_flag("--without-triangles", a->without_triangles, "Leave the ids of triangles out");
  command->add_flag("--overwrite", a->overwrite, "Replace the voxel file if it is there");
  declareLoading(*command, a->load);
  command->footer(kVoxelsFooter);
  command->callback([a] { run(*a); });
}

}  // namespace sightline

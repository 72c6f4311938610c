#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/overwrite.h"
#include "core/cli/share_line.h"
#include "core/cli/solid_option.h"
#include "core/cli/stop_signal.h"
#include "core/cli/voxel_options.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "core/voxel/voxel_file.h"
#include "core/voxel/voxelize.h"

#ifdef SL_HAVE_OPENCL
#include "core/voxel/opencl/voxelize_opencl.h"
#endif

namespace sightline {
namespace {

struct VoxelsArguments {
  std::filesystem::path scene, output;
  VoxelSize size;
  SolidOption solid;
  std::string separate = "conservative";
  std::vector<std::string> attributes;
  std::string device = "cpu";
  uint64_t memory_mib = 1024;
  bool without_triangles = false;
  bool overwrite = false;
  SceneLoadOptions load;
};

Separation separationOf(const std::string& name) {
  return name == "26" ? Separation::k26 : name == "6" ? Separation::k6 : Separation::kConservative;
}

bool wants(const VoxelsArguments& arguments, const std::string& attribute) {
  return std::ranges::find(arguments.attributes, attribute) != arguments.attributes.end();
}

void voxelizeOn(const std::string& device, const Scene& scene, const VoxelizeOptions& options,
                const std::function<void(VoxelBlock&&)>& take) {
  if (device == "cpu") {
    voxelize(scene, options, take);
    return;
  }
#ifdef SL_HAVE_OPENCL
  voxelizeOpenCl(scene, options, device, take);
#else
  throw Error("--device " + device + ": this program was built without OpenCL; take cpu", kExitUsage);
#endif
}

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
  if (levels.front().attribute_bytes != 0) {
    fmt::print("attributes: {:.3f} MiB, {:.2f} bytes a voxel\n",
               double(levels.front().attribute_bytes) / 0x1p20,
               double(levels.front().attribute_bytes) / double(levels.front().voxels));
  }
}

/// Of what is solid, the inside too: all in memory. Blocks' triangles say what is inside, whether they are
/// kept or not.
void writeSolid(const VoxelsArguments& arguments, const Scene& scene, VoxelizeOptions options,
                VoxelWriter& writer) {
  options.with_triangles = true;
  VoxelGrid grid;
  grid.lattice = options.lattice;
  voxelizeOn(arguments.device, scene, options,
             [&](VoxelBlock&& block) { grid.blocks.push_back(std::move(block)); });
  arguments.solid.fill(scene, grid, options.stop);
  for (VoxelBlock& block : grid.blocks) {
    if (arguments.without_triangles) block.triangles.clear();
    writer.add(std::move(block));
  }
}

void run(const VoxelsArguments& arguments) {
  if (arguments.solid.isAsked() && (arguments.separate != "conservative" || !arguments.attributes.empty())) {
    throw Error("voxels: --solid is of conservative voxels, without --attributes", kExitUsage);
  }
  arguments.solid.check();
  // Another name would be taken for a scene by people and by scripts.
  if (lowerExtension(arguments.output) != ".slv") {
    throw Error(fmt::format("{}: must end with .slv", arguments.output.string()), kExitUsage);
  }
  requireSeparate(std::array{arguments.output}, std::array{arguments.scene});
  requireNew(arguments.output, arguments.overwrite);
  const Scene scene = loadScene(arguments.scene, arguments.load);
  const Lattice lattice = arguments.size.of(scene);
  const StopSignal stop;
  ShareLine status("voxelised");
  const VoxelizeOptions options{
      .lattice = lattice,
      .separation = separationOf(arguments.separate),
      .with_triangles = !arguments.without_triangles,
      .attributes = {.normals = wants(arguments, "normal"), .objects = wants(arguments, "object")},
      .memory = arguments.memory_mib << 20,
      .progress = [&](double done,
                      uint64_t voxels) { status.show(done, [&] { return shortCount(voxels) + " voxels"; }); },
      .stop = stop.flag()};
  VoxelHead head = headOf(scene, options);
  head.is_solid = arguments.solid.isAsked();
  VoxelWriter writer(arguments.output, head);
  try {
    if (arguments.solid.isAsked()) {
      writeSolid(arguments, scene, options, writer);
    } else {
      voxelizeOn(arguments.device, scene, options, [&](VoxelBlock&& block) { writer.add(std::move(block)); });
    }
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
    "Every voxel that a triangle meets, and no other: decided exactly, touching\n"
    "counts. A voxel's size is a power of two in the scene's units, and the origin\n"
    "is a corner of voxels. The file holds, for each block of 64 x 64 x 64, the ids\n"
    "of the triangles that meet it, and coarser levels up to the root: a voxel is in\n"
    "one if it has a part in the level below.\n\n"
    "Examples:\n"
    "  sightline voxels city.glb -o city.slv --voxel 0.25\n"
    "  sightline voxels statue.ply -o statue.slv --along 1024 --separate 6\n"
    "  sightline voxels city.glb -o city.slv --voxel 1 --solid winding --closed\n";

}  // namespace

void addVoxelsCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("voxels", "Say which voxels of a lattice a scene meets");
  const auto a = std::make_shared<VoxelsArguments>();
  command->add_option("SCENE", a->scene, "Scene file: .obj, .gltf, .glb or .ply")->required();
  command->add_option("-o,--output", a->output, "Voxel file to write (.slv)")
      ->required()
      ->check(notStandardOutput("a voxel file"));
  a->size.declare(*command);
  a->solid.declare(*command);
  command
      ->add_option(
          "--separate", a->separate,
          "Voxels that keep a surface's sides apart: all that it meets (conservative), or the fewest for "
          "paths by faces, edges and corners (26), or by faces (6)")
      ->check(oneOf({"conservative", "26", "6"}))
      ->type_name("HOW")
      ->capture_default_str();
  command
      ->add_option("--attributes", a->attributes,
                   "Of each voxel, from what is in it, by area: normal, object")
      ->check(oneOf({"normal", "object"}))
      ->delimiter(',')
      ->type_name("NAME");
  command->add_option("--device", a->device, "cpu, or opencl or opencl:N: the same bytes")
      ->check(CLI::Validator(
          [](std::string& text) {
            if (text == "cpu" || text == "opencl" || text.starts_with("opencl:")) return std::string();
            return text + " does not voxelise: expected cpu, opencl or opencl:N";
          },
          ""))
      ->type_name("NAME")
      ->capture_default_str();
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

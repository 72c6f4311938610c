#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>

#include "core/api/session.h"
#include "core/bake/require_scene.h"
#include "core/base/error.h"
#include "core/cli/commands.h"
#include "core/cli/device_check.h"
#include "core/cli/doors_option.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/picture_voxels.h"
#include "core/cli/points.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "core/picture/picture.h"
#include "core/pvs/choose_cell.h"
#include "core/pvs/pvs_file.h"
#include "core/pvs/pvs_writer.h"
#include "core/scene/scene.h"
#include "core/voxel/voxel_file.h"

namespace sightline {
namespace {

constexpr size_t kMissingShown = 10;  ///< ids of missing triangles on one line

struct PictureCommand {
  std::filesystem::path scene, pvs, output, upper;
  std::string cell, view = "outside", device = "opencl", cut = "auto";
  PictureOptions options;
  SceneLoadOptions load;
  DoorState doors = DoorState::kClosed;
  uint32_t level = 0;  ///< of voxels, and reach
  std::vector<std::string> reach;
};

std::string missingList(const Picture& picture) {
  std::string ids;
  for (size_t i = 0; i < std::min(kMissingShown, picture.missing_triangles.size()); ++i) {
    ids += fmt::format("{} {}", i == 0 ? "" : ",", picture.missing_triangles[i]);
  }
  return ids + (picture.missing_triangles.size() > kMissingShown ? ", ..." : "");
}

void drawVoxelFile(const PictureCommand& command) {
  if (!command.pvs.empty() || !command.cell.empty() || !command.upper.empty() || command.view != "outside") {
    throw Error(
        fmt::format(
            "{}: a picture of voxels is of a level, without a set, a cell, a bound or a view from inside",
            command.scene.string()),
        kExitUsage);
  }
  requireSeparate(std::array{command.output}, std::array{command.scene});
  std::optional<double> cut;
  if (command.options.cut == CutMode::kHeight) cut = command.options.cut_height;
  drawVoxels({command.scene, command.output, command.level, command.device, command.options, cut,
              readPoints(command.reach, "--reach")});
}

/// The same cell's set of a file of upper bounds.
CellPvs upperOf(const CellPvs& cell, const Scene& scene, const std::filesystem::path& file) {
  const PvsFile bounds = loadFinishedCells(file);
  requireScene(bounds, scene, file);
  const CellPvs& upper = chooseCell(bounds, cell.cell.name, file);
  if (upper.cell == cell.cell) return upper;
  throw Error(fmt::format("{}: its cell {} is not where that of the set is", file.string(), cell.cell.name));
}

/// Triangles of the bound that are not in the set.
size_t countOpen(const CellPvs& cell, const CellPvs& upper) {
  std::vector<uint32_t> open;
  std::ranges::set_difference(upper.triangles, cell.triangles, std::back_inserter(open));
  return open.size();
}

void draw(const PictureCommand& command) {
  if (lowerExtension(command.output) != ".png") {
    throw Error(fmt::format("{}: must end with .png", command.output.string()), kExitUsage);
  }
  if (isVoxelFile(command.scene)) return drawVoxelFile(command);
  if (!command.reach.empty()) throw Error("--reach: is of voxels (.slv) only", kExitUsage);
  if (command.level != 0) throw Error("--level: is of voxels (.slv) only", kExitUsage);
  if (isVoxelFile(command.pvs)) {
    throw Error(fmt::format("{}: holds voxels, which are drawn without a scene: give them alone",
                            command.pvs.string()),
                kExitUsage);
  }
  if (command.pvs.empty()) throw CLI::RequiredError("pvs");
  if (command.cell.empty()) throw CLI::RequiredError("--cell");
  if (!command.upper.empty() && command.view != "outside") {
    throw Error("--bound: the view from inside has no colours for it", kExitUsage);
  }
  requireSeparate(std::array{command.output}, std::array{command.scene, command.pvs, command.upper});
  const PvsFile baked = loadFinishedCells(command.pvs);
  const PvsFile pvs = inState(baked, command.doors, command.pvs);
  const CellPvs& cell = chooseCell(pvs, command.cell, command.pvs);
  Scene loaded = loadScene(command.scene, command.load);
  requireScene(pvs, loaded, command.pvs);
  std::optional<CellPvs> upper;
  if (!command.upper.empty()) upper = upperOf(cell, loaded, command.upper);
  Session session(inState(std::move(loaded), baked, command.doors), {.device = command.device});
  const Scene& scene = session.scene();
  session.open();
  const TraceRays trace = [&](std::span<const Ray> rays, std::span<Hit> hits) {
    session.traceRays(rays, hits);
  };
  const TraceGlass glass = [&](std::span<const Ray> rays, std::span<const Hit> hits) {
    return session.traceGlass(rays, hits);
  };

  const bool inside = command.view == "inside";
  PictureOptions options = command.options;
  options.cut_height -= float(scene.offset.y);
  const Picture picture = inside
                              ? renderInside(trace, scene, cell, options, glass)
                              : renderOutside(trace, scene, cell, options, glass, upper ? &*upper : nullptr);
  savePng(picture.image, command.output);
  fmt::print("{}: {} from {}, {} of {} triangles\n", command.output.string(), cell.cell.name, command.view,
             cell.triangles.size(), scene.triangleCount());
  if (upper) {
    fmt::print("{} open (ochre), {} proved hidden (dark)\n", countOpen(cell, *upper),
               scene.triangleCount() - upper->triangles.size());
  }
  if (!inside) return;
  fmt::print("{} of {} pixels show a triangle outside the set (red)\n", picture.missing_pixels,
             picture.scene_pixels);
  if (!picture.missing_triangles.empty()) {
    fmt::print("triangles outside the set ({}):{}\n", picture.missing_triangles.size(), missingList(picture));
  }
}

void setCut(PictureOptions& options, const std::string& cut) {
  if (cut == "auto" || cut == "none") {
    options.cut = cut == "auto" ? CutMode::kAuto : CutMode::kNone;
    return;
  }
  options.cut = CutMode::kHeight;
  if (!CLI::detail::lexical_cast(cut, options.cut_height) || !std::isfinite(options.cut_height)) {
    throw CLI::ValidationError("--cut", "must be auto, none or a height, not " + cut);
  }
}

}  // namespace

void addPictureCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("picture", "Draw a set: visible triangles green, missing ones red; or voxels");
  const auto options = std::make_shared<PictureCommand>();
  command->add_option("scene", options->scene, "the scene that was baked; or voxels (.slv), alone")
      ->required()
      ->type_name("SCENE|VOXELS.slv");
  command->add_option("pvs", options->pvs, "a bake, or the .part of one in work")->type_name("OUT.pvs");
  command->add_option("--cell", options->cell, "view cell by name, or by index from 0")->type_name("CELL");
  command->add_option("-o,--output", options->output, "picture to write")
      ->required()
      ->check(notStandardOutput("a picture"))
      ->type_name("FILE.png");
  command
      ->add_option("--view", options->view, "outside: the scene around the cell; inside: what the cell sees")
      ->check(oneOf({"outside", "inside"}))
      ->type_name("VIEW")
      ->capture_default_str();
  command
      ->add_option(
          "--bound", options->upper,
          "outside: the upper bound of the set's cells; what it leaves open is ochre, what it proves "
          "hidden dark")
      ->type_name("UPPER.pvs");
  const CLI::Validator sides = wholeNumber(kMinPictureSide, kMaxPictureSide);
  command->add_option("--width", options->options.width, "pixels")
      ->transform(sides)
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--height", options->options.height, "pixels")
      ->transform(sides)
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option(
          "--cut", options->cut,
          "outside: leave out what is above this height (auto: a ceiling; none), of voxels whole ones")
      ->type_name("Y")
      ->capture_default_str();
  command
      ->add_option("--device", options->device,
                   "cpu, opencl or vulkan; the latter two also with :INDEX or :PART-OF-NAME")
      ->check(deviceName())
      ->type_name("NAME")
      ->capture_default_str();
  command->add_option("--level", options->level, "of voxels: 0 is the finest, each next twice as large")
      ->transform(wholeNumber(0, 31))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option(
          "--reach", options->reach,
          "of voxels: also draw, dark red, what is sealed off from these points, x,y,z, or a file of them")
      ->type_name("X,Y,Z")
      ->expected(1, -1);
  declareLoading(*command, options->load, kAsBakeDid);
  declareDoors(*command, options->doors);
  command->callback([options] {
    setCut(options->options, options->cut);
    draw(*options);
  });
}

}  // namespace sightline

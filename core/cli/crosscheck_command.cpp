#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>

#include "core/bake/status_line.h"
#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/device_check.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/rounding_option.h"
#include "core/cli/stop_signal.h"
#include "core/cli/text_outputs.h"
#include "core/crosscheck/crosscheck.h"
#include "core/crosscheck/crosscheck_report.h"
#include "core/crosscheck/place.h"
#include "core/crosscheck/pvs_difference.h"
#include "core/crosscheck/reproduce.h"
#include "core/device/registry/make_device.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "core/scene/scene_tree.h"

namespace sightline {
namespace {

struct CrosscheckCommand {
  std::filesystem::path scene, cells, report, reproduce;
  std::vector<std::string> devices, kinds;
  double scale = 1, move = 0;
  CrosscheckOptions options;
  CrosscheckLimits limits;
  SceneLoadOptions load;
  bool spatial_splits = false, pvs = false, overwrite = false;
  uint32_t n_rand = 1'000'000;
};

/// What all devices hold.
struct Level {
  const Scene& scene;
  const Bvh& bvh;
  const std::vector<ViewCell>& cells;
};

/// The devices that --devices names; where none of them bakes, the cpu too.
class Devices {
 public:
  Devices(const std::vector<std::string>& names, const Scene& scene, const Bvh& bvh) {
    for (const std::string& name : names) {
      Tracer& tracer = whyNoBakes(name).empty() ? addBaker(name, scene, bvh)
                                                : *owned_.emplace_back(makeTracer(name, scene, bvh));
      for (const Tracer* earlier : tracers_) {
        if (earlier->info().id != tracer.info().id) continue;
        throw Error(fmt::format("--devices: {} is {}, which is named already; name another", name,
                                earlier->info().id),
                    kExitUsage);
      }
      tracers_.push_back(&tracer);
    }
    if (bakers_.empty()) addBaker("cpu", scene, bvh);
  }

  std::span<Tracer* const> tracers() const { return tracers_; }
  /// At least one; all of tracers() where all of them bake.
  std::span<Device* const> bakers() const { return bakers_; }

 private:
  Tracer& addBaker(const std::string& name, const Scene& scene, const Bvh& bvh) {
    std::unique_ptr<Device> device = makeDevice(name, scene, bvh);
    bakers_.push_back(device.get());
    return *owned_.emplace_back(std::move(device));
  }

  std::vector<std::unique_ptr<Tracer>> owned_;
  std::vector<Tracer*> tracers_;
  std::vector<Device*> bakers_;
};

/// Disagreements that are written in full.
constexpr uint32_t kReproducers = 100;

/// Writes a file for each of the disagreements that the report holds in full.
void writeReproducers(const CrosscheckCommand& command, const Level& level, const CrosscheckReport& report) {
  const size_t removed = removeReproducers(command.reproduce);
  if (removed > 0) fmt::print("{}: {} of an earlier run removed\n", command.reproduce.string(), removed);
  const Judge judge(level.scene, level.bvh);
  ReproducerHead head;
  head.scene_name = command.scene.filename().string();
  for (const DeviceInfo& device : report.devices) head.devices.push_back(device.id);
  if (command.options.rounding.steps != RoundingLimit{}.steps) {
    head.options = fmt::format(" --rounding {}", command.options.rounding.steps);
  }
  const auto maker = [&](size_t d, const Scene& part, const Bvh& tree) {
    return makeTracer(report.devices[d].id, part, tree);
  };
  StatusLine status;
  size_t written = 0, not_alone = 0;
  for (const CheckedRay& ray : report.disagreements.rays) {
    status.show([&] { return fmt::format("writing disagreement {}", written + 1); });
    const Reproducer its = findReproducer(level.scene, judge, ray.answers, maker, command.options.rounding);
    head.what =
        fmt::format("{} ray {} of cell {}", rayKindName(ray.kind), ray.number, level.cells[ray.cell].name);
    head.file_name = reproducerName(written++);
    saveText(reproducerText(head, its), command.reproduce / head.file_name);
    if (!its.scene.surfaces.empty()) saveText(materialsText(), command.reproduce / kMaterialsName);
    not_alone += !its.reproduces;
  }
  status.end();
  fmt::print("{}: {}, {} of them more than rounding: {} written, of which {} on the few triangles\n",
             command.reproduce.string(), counted(report.disagreements.count, "disagreement"),
             report.disagreements.illegal, written,
             not_alone == 1 ? "1 does not reproduce" : fmt::format("{} do not reproduce", not_alone));
}

/// Bakes every cell on the first device and on each other one, says and returns how the sets differ, of as
/// many cells as were done before a stop signal. Counts in the report what is wrong in the sets.
Json comparePvsOfAll(const CrosscheckCommand& command, const Level& level, std::span<Device* const> devices,
                     const StopSignal& stop, CrosscheckReport& report) {
  StatusLine status;
  const std::vector<ViewCell>& cells = level.cells;
  const Judge judge(level.scene, level.bvh);
  BakeParams params;
  params.n_rand = command.n_rand;
  params.validation_rays = 0;
  params.seed = command.options.seed;
  Json pairs = Json::array();
  report.wrong_in_sets.assign(devices.size(), 0);
  for (size_t d = 1; d < devices.size() && stop.exitCode() == 0; ++d) {
    const std::string first = devices[0]->info().id, other = devices[d]->info().id;
    std::vector<PvsDifference> differences;
    try {
      for (uint32_t c = 0; c < cells.size(); ++c) {
        const auto show = [&](const BakeProgress& progress) {
          status.show([&] {
            return fmt::format("sets of {} and {}: {}  {} rays  PVS {}", first, other, cells[c].name,
                               shortCount(progress.rays), progress.pvs_size);
          });
        };
        differences.push_back(comparePvs(judge, level.scene, cells[c], c, *devices[0], *devices[d], params,
                                         command.options.rounding, {.progress = show, .stop = stop.flag()}));
      }
    } catch (const Interrupted&) {
      // The cells before it are shown.
    }
    status.end();
    for (const PvsDifference& cell : differences) {
      if (d == 1) report.wrong_in_sets[0] += cell.faults(0);  // its set is the same in each pair
      report.wrong_in_sets[d] += cell.faults(1);
    }
    std::fputs(pvsDifferenceTable(first, other, differences).c_str(), stdout);
    pairs.push_back(pvsDifferenceJson(first, other, differences));
  }
  return pairs;
}

void run(const CrosscheckCommand& command) {
  requireSeparate(std::array{command.report}, std::array{command.scene, command.cells});
  if (!command.reproduce.empty()) {
    prepareReproducerFolder(command.reproduce, command.overwrite, std::array{command.scene, command.cells});
  }
  const TextOutputs outputs({&command.report, 1});
  Scene scene = loadScene(command.scene, command.load);
  std::vector<ViewCell> cells = moved(loadCells(command.cells), -scene.offset);
  placeElsewhere(scene, cells, command.scale, command.move);
  for (const std::string& name : command.devices) requireDevice(name);
  const Bvh bvh = buildSceneTree(scene, {.spatial_splits = command.spatial_splits});
  const Devices devices(command.devices, scene, bvh);

  CrosscheckHead head{SL_VERSION,      summarize(scene, command.scene.filename().string(), hashScene(scene)),
                      command.scale,   command.move,
                      command.options, {}};
  for (const ViewCell& cell : cells) head.cells.push_back(cell.name);
  fmt::print("{}: {} triangles, {}", command.scene.string(), scene.triangleCount(),
             counted(cells.size(), "cell"));
  for (const Tracer* device : devices.tracers())
    fmt::print("; {}, {}", device->info().id, device->info().name);
  fmt::print("\n");

  StopSignal stop;
  StatusLine status;
  CrosscheckReport report = crosscheck(
      scene, bvh, cells, devices.tracers(), *devices.bakers().front(), command.options,
      [&](RayKind kind, uint64_t done, uint64_t due) {
        status.show([&] {
          return fmt::format("{:<10}  {} of {} rays", rayKindName(kind), shortCount(done), shortCount(due));
        });
      },
      stop.flag());
  status.end();
  std::fputs(crosscheckTable(report).c_str(), stdout);
  fmt::print("traced in {}, judged in {}\n", shortDuration(report.trace_seconds),
             shortDuration(report.judge_seconds));
  Json json = crosscheckJson(head, report);
  if (command.pvs && stop.exitCode() == 0) {
    json["pvs"] = comparePvsOfAll(command, {scene, bvh, cells}, devices.bakers(), stop, report);
  }
  json["complete"] = stop.exitCode() == 0;
  outputs.save(jsonText(json), command.report);
  if (!command.reproduce.empty()) writeReproducers(command, {scene, bvh, cells}, report);
  if (stop.exitCode() != 0) {
    fmt::print("stopped: the table holds what was judged by then\n");
    throw ExitCode{stop.exitCode()};
  }
  const auto past = pastLimits(report, command.limits);
  for (const std::string& line : past) fmt::print("past the limit: {}\n", line);
  if (!past.empty()) throw ExitCode{kExitPastLimit};
}

std::vector<std::string> allKinds() {
  std::vector<std::string> names;
  for (uint32_t i = 0; i < kRayKinds; ++i) names.push_back(rayKindName(RayKind(i)));
  return names;
}

void declareLimits(CLI::App& command, CrosscheckLimits& limits) {
  const auto declare = [&](const char* name, auto& limit, const char* help) {
    return command.add_option(name, limit, help)->group("Limits of any one device (else exit code 3)");
  };
  const auto count = [&](const char* name, std::optional<uint64_t>& limit, const char* help) {
    declare(name, limit, help)->transform(wholeNumber())->type_name("N");
  };
  count("--max-wrong", limits.wrong,
        "answers that the judge finds wrong, and with --pvs triangles not of their cell");
  count("--max-missed", limits.missed, "hits that the judge finds lost");
  count("--max-rounded", limits.rounded, "answers that are right up to rounding only");
  count("--max-differences", limits.differences, "other triangles than the first device's");
  declare("--max-ulps", limits.ulps, "error of a distance, in units in the last place")
      ->check(between(0, 1e18))
      ->type_name("X");
}

constexpr const char* kCrosscheckFooter =
    "Examples:\n"
    "  sightline crosscheck city.glb --cells cells.json --devices cpu,opencl\n"
    "  sightline crosscheck city.glb --cells cells.json --devices cpu,opencl \\\n"
    "      --kinds vertex,edge --rays 10k --max-wrong 0 --max-missed 0\n";

}  // namespace

void addCrosscheckCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("crosscheck", "Trace the same rays on several devices; an exact judge decides");
  const auto options = std::make_shared<CrosscheckCommand>();
  command->add_option("scene", options->scene, ".obj, .gltf, .glb or .ply")->required()->type_name("SCENE");
  command->add_option("--cells", options->cells, "view cells, JSON")->required()->type_name("CELLS.json");
  command->add_option("--devices", options->devices, "devices to compare, the first is compared with")
      ->required()
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(tracerName())
      ->type_name("A,B,...");
  command->add_option("--rays", options->options.rays, "rays of each kind, over all cells")
      ->transform(wholeNumber(1, uint64_t(1) << 40))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--kinds", options->kinds,
                   "random, border, reverse, vertex, edge, along-edge, axis, grazing, plane, far-tiny "
                   "(default: all)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(oneOf(allKinds()).description(""))
      ->type_name("KIND,...");
  command->add_option("--seed", options->options.seed, "seed of the rays")
      ->transform(wholeNumber())
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--check-every", options->options.check_every,
                   "the judge looks at 1 in so many rays on which all agree (0: none)")
      ->transform(wholeNumber())
      ->type_name("N")
      ->capture_default_str();
  declareRounding(*command, options->options.rounding);
  command->add_option("--scale", options->scale, "multiply scene and cells by this first")
      ->check(between(1e-38, 1e38))
      ->type_name("X")
      ->capture_default_str();
  command->add_option("--move", options->move, "then move them by this along x, y and z")
      ->check(between(-1e30, 1e30))
      ->type_name("X")
      ->capture_default_str();
  command
      ->add_option("--report", options->report,
                   "write everything as JSON (docs/report.md); - is standard output")
      ->type_name("R.json");
  command
      ->add_option("--reproduce", options->reproduce,
                   "write for each of the first 100 disagreements the triangles around the ray, as OBJ")
      ->type_name("DIR");
  command->add_flag("--overwrite", options->overwrite, "replace reproducers of an earlier run");
  command->add_flag("--spatial-splits", options->spatial_splits, "trace the tree with spatial splits");
  declareLoading(*command, options->load);
  command->add_flag("--pvs", options->pvs,
                    "also bake on each device (two or more), and explain how the sets differ");
  command->add_option("--n-rand", options->n_rand, "random rays an iteration of these bakes")
      ->transform(wholeNumber(1, 4'294'967'293))
      ->type_name("N")
      ->capture_default_str();
  declareLimits(*command, options->limits);
  command->footer(kCrosscheckFooter);
  command->callback([options] {
    requireDistinct("--devices", options->devices);
    requireDistinct("--kinds", options->kinds);
    if (options->pvs && options->devices.size() < 2) {
      throw CLI::ValidationError("--pvs", "compares the sets of two devices; name another in --devices");
    }
    for (const std::string& name : options->devices) {
      if (!options->pvs || whyNoBakes(name).empty()) continue;
      throw CLI::ValidationError("--pvs",
                                 name + " traces rays only and has no sets; leave it out of --devices");
    }
    if (!options->reproduce.empty()) options->options.keep_disagreements = kReproducers;
    for (const std::string& name : options->kinds) {
      options->options.kinds.push_back(*rayKindOf(name));
    }
    run(*options);
  });
}

}  // namespace sightline

#include <fmt/core.h>

#include <array>
#include <chrono>
#include <exception>

#include "core/bake/bake.h"
#include "core/bake/bake_page.h"
#include "core/bake/cell_table.h"
#include "core/bake/progress.h"
#include "core/bake/report.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/bake_options.h"
#include "core/cli/cell_warnings.h"
#include "core/cli/command_line.h"
#include "core/cli/commands.h"
#include "core/cli/stop_signal.h"
#include "core/cli/text_outputs.h"
#include "core/device/naive/naive_device.h"
#include "core/device/registry/make_device.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/gvs/algorithm_revision.h"
#include "core/io/file_io.h"
#include "core/picture/cell_pictures.h"
#include "core/trace/cpu_tracer.h"

namespace sightline {
namespace {

void say(const std::string& line) {
  std::fputs((line + "\n").c_str(), stdout);
  std::fflush(stdout);
}

/// The inputs, as the head of the file that is to be made.
PvsFile inputsOf(const BakeOptions& options, const Scene& scene) {
  PvsFile inputs;
  inputs.algorithm = kAlgorithmRevision;
  inputs.intersector = intersectorOf(requireDevice(options.device));
  inputs.scene_hash = hashScene(scene);
  inputs.triangle_count = uint32_t(scene.triangles.size());
  inputs.scene_name = options.scene.filename().string();
  inputs.params = options.params;
  inputs.has_witnesses = options.witnesses;
  inputs.planned = loadCells(options.cells);
  return inputs;
}

BakeReport startReport(const BakeOptions& options, const Scene& scene, const Bake& bake) {
  BakeReport report;
  report.version = SL_VERSION;
  report.scene = summarize(scene, bake.head().scene_name, bake.head().scene_hash);
  report.spatial_splits = options.spatial_splits;
  report.witnesses = options.witnesses;
  report.repair = options.repair;
  report.params = options.params;
  report.planned_cells = bake.head().planned.size();
  report.resumed_cells = bake.resumed();
  for (const std::string& warning : sceneWarnings(report.scene)) say("warning: " + warning);
  return report;
}

void sayKept(const Bake& bake, const char* why) {
  say(fmt::format("{}: {} of {} cells are kept in {}; the same command goes on after them", why,
                  bake.finished().size(), bake.head().planned.size(), bake.partFile().string()));
}

/// The tree and the device that refers to it.
struct TreeAndDevice {
  Bvh bvh;
  std::unique_ptr<Device> device;
};

/// Fills `tracer` in place: the device refers to its tree.
void openTracer(TreeAndDevice& tracer, const BakeOptions& options, const Scene& scene, BakeReport& report) {
  requireDevice(options.device);
  BvhConfig config;
  config.spatial_splits = options.spatial_splits;
  config.threads = options.device_options.threads;
  tracer.bvh = buildBvh(scene.positions, scene.triangles, config);
  report.tree = summarize(tracer.bvh);
  say(fmt::format("tree: built in {}, SAH cost {:.1f}, depth {}", shortDuration(report.tree->build_seconds),
                  report.tree->sah_cost, report.tree->depth));
  tracer.device = makeDevice(options.device, scene, tracer.bvh, options.device_options);
  if (options.params.method == Method::kNaive) {
    tracer.device = makeNaiveDevice(std::move(tracer.device), scene);
  }
  report.device = tracer.device->info();
  report.set = tracer.device->counters().hash_set ? "hash" : "array";
  say(fmt::format("device: {}, {}", report.device->id, report.device->name));
  if (const DeviceInfo& info = *report.device; info.driver_tree_parts > 0) {
    say(fmt::format("driver's tree: built in {}, {:.1f} MiB in {}",
                    shortDuration(info.driver_tree_build_seconds), double(info.driver_tree_bytes) / 0x1p20,
                    counted(info.driver_tree_parts, "part")));
  }
}

NearestHits nearestHits(Tracer& device) {
  return [&device](std::span<const Ray> rays, std::span<Hit> hits) { device.traceRays(rays, hits); };
}

/// Warnings of the planned cells, by the device, or without one (of a complete bake) by a tree made for it.
std::vector<std::vector<CellWarning>> checkPlanned(const BakeOptions& options, const Scene& scene,
                                                   const Bake& bake, const TreeAndDevice& tracer) {
  const std::vector<ViewCell>& cells = bake.head().planned;
  if (tracer.device) {
    return checkCells(scene, tracer.bvh, cells, options.free_side, nearestHits(*tracer.device));
  }
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const CpuTracer cpu(scene, bvh);
  return checkCells(scene, bvh, cells, options.free_side,
                    [&cpu](std::span<const Ray> rays, std::span<Hit> hits) {
                      for (size_t i = 0; i < rays.size(); ++i) hits[i] = cpu.trace(rays[i]);
                    });
}

/// Says what can be said of the cells before the bake. Throws Error with --strict-cells.
void warnOfCells(const BakeOptions& options, const Scene& scene, const Bake& bake,
                 const TreeAndDevice& tracer, BakeReport& report, CellWarningPrinter& printer) {
  report.warnings = checkPlanned(options, scene, bake, tracer);
  std::vector<WarnedCell> cells;
  for (size_t i = 0; i < report.warnings.size(); ++i) {
    cells.push_back({bake.head().planned[i].name, report.warnings[i]});
  }
  if (options.strict_cells) refuseWarnedCells(cells);
  for (const auto& [name, warnings] : cells) printer.say(name, warnings);
  printer.end();
}

/// Bakes what is missing, with progress, and keeps how the sets grew for the page. Returns the exit code.
int bakeCells(const BakeOptions& options, const Scene& scene, Device& device, Bake& bake, BakePage& page,
              CellWarningPrinter& warnings) {
  if (!bake.partProblem().empty()) {
    say(fmt::format("{}: cut off or damaged after {} ({}); the rest is baked again", bake.partFile().string(),
                    counted(bake.resumed(), "whole cell"), bake.partProblem()));
  }
  if (bake.resumed() != 0) {
    say(fmt::format("{}: goes on after {} of {} cells, begun on {}", bake.partFile().string(), bake.resumed(),
                    bake.head().planned.size(), bake.head().device));
  }
  StopSignal stop;
  ProgressPrinter printer(stdout, terminalColumns(stdout), bake.head().planned, bake.finished());
  const auto baker = [&](const ViewCell& cell, uint32_t index, const ProgressCallback& progress) {
    BakeTrace trace;
    CellPvs pvs = bakeCell(device, scene, cell, index, options.params, {progress, stop.flag(), &trace});
    page.curves.resize(index);  // empty for cells of an earlier run
    page.curves.push_back(std::move(trace.curve));
    if (!options.witnesses) pvs.witnesses.clear();
    return pvs;
  };
  BakeEvents events;
  events.progress = [&](uint32_t index, const BakeProgress& progress) { printer.progress(index, progress); };
  const uint64_t triangles = scene.triangles.size() - scene.degenerate_triangles;
  events.cell_done = [&](uint32_t index, const CellPvs& pvs) {
    printer.cellDone(index, summarize(pvs));
    if (const auto warning = checkSetSize(pvs.triangles.size(), triangles)) {
      warnings.say(pvs.cell.name, {&*warning, 1});
    }
  };
  try {
    const DeviceInfo info = device.info();
    if (bake.run(info.id + ", " + info.name, baker, events, stop.flag())) return 0;
  } catch (...) {
    printer.breakLine();
    sayKept(bake, "failed");
    throw;
  }
  printer.breakLine();
  sayKept(bake, "stopped");
  return stop.exitCode();
}

std::vector<uint8_t> readPicture(const std::filesystem::path& file) {
  const FileBytes bytes = readFile(file);
  return {bytes.view().begin(), bytes.view().end()};
}

/// Draws the pictures, and adds them to the page if one is written. Returns the exit code.
int drawCells(const BakeOptions& options, const Scene& scene, Tracer& device, BakePage& page) {
  const TraceRays trace = nearestHits(device);
  const PvsFile pvs = loadPvs(options.out);
  const StopSignal stop;
  for (uint32_t i = 0; i < pvs.cells.size(); ++i) {
    if (stop.exitCode() != 0) {
      say(fmt::format("stopped: pictures of {} of {} cells are drawn", i, pvs.cells.size()));
      break;
    }
    const double missing = saveCellPictures(trace, scene, pvs.cells[i], i, options.pictures);
    const std::string& name = pvs.cells[i].cell.name;
    const std::string file = (options.pictures / pictureName(name, i)).string();
    say(fmt::format("{}: {:.2g} of the pixels from inside show a missing triangle", file, missing));
    if (options.html.empty()) continue;
    page.pictures.push_back({readPicture(file + "-outside.png"), name + " from outside"});
    page.pictures.push_back({readPicture(file + "-inside.png"),
                             fmt::format("{} from inside, {:.2g} of the pixels missing", name, missing)});
  }
  return stop.exitCode();
}

/// Runs steps of which one that fails must not cost the others; the first failure is thrown at the end.
class Steps {
 public:
  void run(auto&& step) {
    try {
      step();
    } catch (...) {
      if (!problem_) problem_ = std::current_exception();
    }
  }
  void end() const {
    if (problem_) std::rethrow_exception(problem_);
  }

 private:
  std::exception_ptr problem_;
};

void writePage(const BakeOptions& options, const BakeReport& report, const TextOutputs& outputs,
               BakePage& page, Steps& steps) {
  page.curves.resize(report.cells.size());
  page.command = commandLine();
  if (!options.csv.empty()) {
    steps.run([&] { outputs.save(curvesCsv(report, page.curves), options.csv); });
  }
  if (!options.html.empty()) {
    steps.run([&] { outputs.save(bakePage(report, page).html(), options.html); });
  }
}

void fillReport(const Bake& bake, BakeReport& report) {
  report.cells = bake.finished();
  report.baked_on = bake.head().device;
  report.peak_process_bytes = peakProcessBytes();
}

/// The finished cells, with what there is to say about their sets, too.
std::vector<WarnedCell> warnedCells(const BakeReport& report) {
  std::vector<WarnedCell> cells;
  for (size_t i = 0; i < report.cells.size(); ++i) {
    cells.push_back({report.cells[i].cell.name, warningsOf(report, i)});
  }
  return cells;
}

void sayTable(const BakeReport& report, const std::vector<WarnedCell>& warned) {
  std::vector<std::vector<CellWarning>> warnings;
  for (const WarnedCell& cell : warned) warnings.push_back(cell.second);
  std::fputs(("\n" + cellTable(report.cells, uint32_t(report.scene.triangles), warnings)).c_str(), stdout);
  std::fflush(stdout);
}

void runBake(const BakeOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  checkParams(options.params);
  requireMethodOn(options.params.method, options.device);
  const std::array reports = {options.report, options.html, options.csv};
  requireSeparate(std::array{options.out, partFileOf(options.out), options.report, options.html, options.csv,
                             options.pictures},
                  std::array{options.scene, options.cells});
  if (!options.pictures.empty()) makeFolder(options.pictures);
  const TextOutputs outputs(reports);
  const Scene scene = loadScene(options.scene, {.repair = options.repair});
  Bake bake(inputsOf(options, scene), options.out, options.overwrite);
  say(fmt::format("{}: {} triangles, {}; {}", options.scene.string(), scene.triangles.size(),
                  counted(scene.objects.size(), "object"), counted(bake.head().planned.size(), "cell")));
  BakeReport report = startReport(options, scene, bake);

  int exit_code = 0;
  BakePage page;
  TreeAndDevice tracer;
  if (bake.complete()) {
    say(fmt::format("{}: already complete, nothing to bake (--overwrite bakes again)", options.out.string()));
  }
  if (!bake.complete() || !options.pictures.empty()) {
    openTracer(tracer, options, scene, report);
  }
  CellWarningPrinter printer;
  warnOfCells(options, scene, bake, tracer, report, printer);
  if (!bake.complete()) exit_code = bakeCells(options, scene, *tracer.device, bake, page, printer);
  printer.end();

  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fillReport(bake, report);
  const std::vector<WarnedCell> warned = warnedCells(report);
  if (!report.cells.empty()) sayTable(report, warned);
  Steps steps;
  if (!options.report.empty()) steps.run([&] { outputs.save(reportJson(report), options.report); });
  if (exit_code == 0 && !options.pictures.empty()) {
    steps.run([&] { exit_code = drawCells(options, scene, *tracer.device, page); });
  }
  writePage(options, report, outputs, page, steps);
  steps.end();
  if (exit_code != 0) throw ExitCode{exit_code};
  if (options.strict_cells) refuseWarnedCells(warned);
}

}  // namespace

void addBakeCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bake", "Compute the potentially visible set of each view cell");
  const auto options = std::make_shared<BakeOptions>();
  declareOptions(*command, *options);
  command->callback([options] { runBake(*options); });
}

}  // namespace sightline

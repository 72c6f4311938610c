#include <fmt/core.h>

#include <array>
#include <chrono>
#include <exception>
#include <optional>

#include "core/api/bake_steps.h"
#include "core/api/session_parts.h"
#include "core/bake/bake.h"
#include "core/bake/bake_page.h"
#include "core/bake/cell_table.h"
#include "core/bake/progress.h"
#include "core/bake/report.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/bake_options.h"
#include "core/cli/bound_states.h"
#include "core/cli/cell_warnings.h"
#include "core/cli/command_line.h"
#include "core/cli/commands.h"
#include "core/cli/stop_signal.h"
#include "core/cli/text_outputs.h"
#include "core/device/registry/device_names.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "core/picture/cell_pictures.h"
#include "core/pvs/door_state.h"
#include "core/scene/find_objects.h"
#include "core/scene/seen_through.h"
#include "core/trace/cpu_tracer.h"

namespace sightline {
namespace {

void say(const std::string& line) {
  std::fputs((line + "\n").c_str(), stdout);
  std::fflush(stdout);
}

BakeReport startReport(const BakeOptions& options, const Scene& scene, const Bake& bake) {
  BakeReport report;
  report.version = SL_VERSION;
  report.scene = summarize(scene, bake.head().scene_name, bake.head().scene_hash);
  report.spatial_splits = options.spatial_splits;
  report.witnesses = options.witnesses;
  report.repair = options.load.repair;
  report.ignored_extensions = options.load.ignored_extensions;
  report.params = bake.head().params;
  report.doors = bake.head().doors;
  report.see_through = bake.head().see_through;
  report.planned_cells = bake.head().planned.size();
  report.resumed_cells = bake.resumed();
  for (const std::string& warning : sceneWarnings(report.scene)) say("warning: " + warning);
  return report;
}

void sayKept(const Bake& bake, const char* why) {
  say(fmt::format("{}: {} of {} cells are kept in {}; the same command goes on after them", why,
                  bake.finished().size(), bake.head().planned.size(), bake.partFile().string()));
}

void sayDoors(const std::vector<NamedTriangles>& doors) {
  if (doors.empty()) return;
  uint64_t triangles = 0;
  for (const NamedTriangles& door : doors) triangles += door.count;
  say(fmt::format("doors: {} of {}, each cell is baked with them closed and open",
                  counted(doors.size(), "object"), counted(triangles, "triangle")));
}

SessionOptions sessionOptions(const BakeOptions& options, const Scene& scene) {
  return {.device = options.device,
          .device_options = options.device_options,
          .spatial_splits = options.spatial_splits,
          .see_through = findObjects(scene, options.see_through, "--see-through"),
          .scene_name = options.scene.filename().string()};
}

/// Opens the device that bakes, and says what it is.
void openDevice(const BakeOptions& options, Session& session, BakeReport& report) {
  requireDevice(options.device);
  report.tree = summarize(session.parts().tree());
  say(fmt::format("tree: built in {}, SAH cost {:.1f}, depth {}", shortDuration(report.tree->build_seconds),
                  report.tree->sah_cost, report.tree->depth));
  Device& device = session.parts().device(options.params.method, options.params.smallest_hole);
  report.device = device.info();
  report.set = device.counters().hash_set ? "hash" : "array";
  say(fmt::format("device: {}, {}", report.device->id, report.device->name));
  if (const DeviceInfo& info = *report.device; info.driver_tree_parts > 0) {
    say(fmt::format("driver's tree: built in {}, {:.1f} MiB in {}",
                    shortDuration(info.driver_tree_build_seconds), double(info.driver_tree_bytes) / 0x1p20,
                    counted(info.driver_tree_parts, "part")));
  }
}

NearestHits nearestHits(Session& session) {
  return [&session](std::span<const Ray> rays, std::span<Hit> hits) { session.traceRays(rays, hits); };
}

/// Warnings of the planned cells, by the device if it is open, else (of a complete bake) on the host.
std::vector<std::vector<CellWarning>> checkPlanned(const BakeOptions& options, Session& session,
                                                   const Bake& bake) {
  const std::vector<ViewCell>& cells = bake.head().planned;
  const Scene& scene = session.scene();
  const Bvh& bvh = session.parts().tree();
  if (session.parts().isOpen()) {
    return checkCells(scene, bvh, cells, options.free_side, nearestHits(session));
  }
  const CpuTracer cpu(scene, bvh);
  return checkCells(scene, bvh, cells, options.free_side,
                    [&cpu](std::span<const Ray> rays, std::span<Hit> hits) {
                      for (size_t i = 0; i < rays.size(); ++i) hits[i] = cpu.trace(rays[i]);
                    });
}

/// Says what can be said of the cells before the bake. Throws Error with --strict-cells.
void warnOfCells(const BakeOptions& options, Session& session, const Bake& bake, BakeReport& report,
                 CellWarningPrinter& printer) {
  report.warnings = checkPlanned(options, session, bake);
  std::vector<WarnedCell> cells;
  for (size_t i = 0; i < report.warnings.size(); ++i) {
    cells.push_back({bake.head().planned[i].name, report.warnings[i]});
  }
  if (options.strict_cells) refuseWarnedCells(cells);
  for (const auto& [name, warnings] : cells) printer.say(name, warnings);
  printer.end();
}

/// Bakes what is missing, with progress, and keeps how the sets grew for the page. Returns the exit code.
int bakeCells(Session& session, Bake& bake, const PvsFile* bound, BakePage& page, BakeReport& report,
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
  BakeEvents events;
  events.stop = stop.flag();
  events.progress = [&](uint32_t index, const BakeProgress& progress) { printer.progress(index, progress); };
  events.grown = [&](uint32_t index, BakeTrace trace) {
    page.curves.resize(index);  // empty for cells of an earlier run
    page.curves.push_back(std::move(trace.curve));
  };
  events.leaks = [&](uint32_t index, const Leaks& leaks) {
    report.leaks.resize(index);
    report.leaks.push_back(leaks);
  };
  const uint64_t triangles = session.scene().triangleCount() - session.scene().degenerate_triangles;
  events.cell_done = [&](uint32_t index, const CellPvs& pvs) {
    printer.cellDone(index, summarize(pvs));
    if (const auto warning = checkSetSize(pvs.triangles.size(), triangles)) {
      warnings.say(pvs.cell.name, {&*warning, 1});
    }
    const std::string leaks =
        index < report.leaks.size() && report.leaks[index] ? leaksText(*report.leaks[index]) : "";
    if (!leaks.empty()) say(fmt::format("{}: {}", pvs.cell.name, leaks));
  };
  try {
    if (runBake(session, bake, events, bound)) return 0;
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

/// Draws the cells, and adds them to the page if one is written. state: after the names of cells.
void drawCells(const BakeOptions& options, Session& session, const PvsFile& pvs, const std::string& state,
               const StopSignal& stop, BakePage& page) {
  const TraceRays trace = nearestHits(session);
  const TraceGlass glass = [&](std::span<const Ray> rays, std::span<const Hit> hits) {
    return session.traceGlass(rays, hits);
  };
  for (uint32_t i = 0; i < pvs.cells.size(); ++i) {
    if (stop.exitCode() != 0) {
      say(fmt::format("stopped: pictures of {} of {} cells are drawn", i, pvs.cells.size()));
      break;
    }
    CellPvs cell = pvs.cells[i];
    const std::string said = cell.cell.name + (state.empty() ? "" : ", doors " + state);
    if (!state.empty()) cell.cell.name += "-" + state;
    const double missing = saveCellPictures(trace, session.scene(), cell, i, options.pictures, glass);
    const std::string file = (options.pictures / pictureName(cell.cell.name, i)).string();
    say(fmt::format("{}: {:.2g} of the pixels from inside show a missing triangle", file, missing));
    if (options.html.empty()) continue;
    page.pictures.push_back({readPicture(file + "-outside.png"), said + " from outside"});
    page.pictures.push_back({readPicture(file + "-inside.png"),
                             fmt::format("{} from inside, {:.2g} of the pixels missing", said, missing)});
  }
}

/// Draws the pictures; where there are doors, of both their states. Returns the exit code.
int drawPictures(const BakeOptions& options, Session& session, BakePage& page) {
  const PvsFile pvs = loadPvs(options.out);
  const StopSignal stop;
  const bool doors = !pvs.doors.empty();
  drawCells(options, session, inState(pvs, DoorState::kClosed, options.out), doors ? "closed" : "", stop,
            page);
  if (!doors || stop.exitCode() != 0) return stop.exitCode();
  Session open(seenThrough(session.scene(), pvs.doors), session.options());
  drawCells(options, open, inState(pvs, DoorState::kOpen, options.out), "open", stop, page);
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

void fillReport(const Bake& bake, const PvsFile* bound, BakeReport& report) {
  report.cells = bake.finished();
  for (const CellSummary& cell : report.cells) {
    if (bound) report.bounds.push_back(findCell(*bound, cell.cell.name).triangles.size());
  }
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
                  std::array{options.scene, options.cells, options.bound});
  if (!options.pictures.empty()) makeFolder(options.pictures);
  const TextOutputs outputs(reports);
  Scene loaded = loadScene(options.scene, options.load);
  SessionOptions session_options = sessionOptions(options, loaded);
  Session session(std::move(loaded), std::move(session_options));
  const Scene& scene = session.scene();
  const BakeContent content(options.witnesses ? Witnesses::kKeep : Witnesses::kDrop,
                            findObjects(scene, options.doors, "--doors"));
  std::optional<PvsFile> bound;
  BakeParams params = options.params;
  if (!options.bound.empty()) {
    bound = loadPvs(options.bound);
    params.bound = bound->params.bound;
  }
  PvsFile inputs = bakeInputs(session, loadCells(options.cells), params, content);
  if (bound) requireBound(*bound, inputs, options.bound);
  Bake bake(std::move(inputs), options.out, options.overwrite);
  sayDoors(bake.head().doors);
  say(fmt::format("{}: {} triangles, {}; {}", options.scene.string(), scene.triangleCount(),
                  counted(scene.objects.size(), "object"), counted(bake.head().planned.size(), "cell")));
  if (scene.hasInstances()) {
    say(fmt::format("instances: {}; {} triangles are stored (--flatten writes them out)",
                    scene.instances.size(), scene.triangles.size()));
  }
  BakeReport report = startReport(options, scene, bake);

  int exit_code = 0;
  BakePage page;
  if (bake.complete()) {
    say(fmt::format("{}: already complete, nothing to bake (--overwrite bakes again)", options.out.string()));
  }
  if (!bake.complete() || !options.pictures.empty()) {
    openDevice(options, session, report);
  }
  CellWarningPrinter printer;
  warnOfCells(options, session, bake, report, printer);
  if (!bake.complete())
    exit_code = bakeCells(session, bake, bound ? &*bound : nullptr, page, report, printer);
  printer.end();

  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fillReport(bake, bound ? &*bound : nullptr, report);
  const std::vector<WarnedCell> warned = warnedCells(report);
  if (!report.cells.empty()) sayTable(report, warned);
  for (size_t i = 0; i < report.bounds.size(); ++i) {
    const CellSummary& cell = report.cells[i];
    say(fmt::format("{}: {}", cell.cell.name,
                    statesText(cell.pvs_size, report.bounds[i], report.scene.triangles)));
  }
  Steps steps;
  if (!options.report.empty()) steps.run([&] { outputs.save(reportJson(report), options.report); });
  if (exit_code == 0 && !options.pictures.empty()) {
    steps.run([&] { exit_code = drawPictures(options, session, page); });
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

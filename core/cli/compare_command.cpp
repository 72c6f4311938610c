#include <fmt/core.h>

#include <array>
#include <filesystem>
#include <memory>

#include "core/api/session_parts.h"
#include "core/bake/status_line.h"
#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/base/text.h"
#include "core/cli/bake_options.h"
#include "core/cli/command_line.h"
#include "core/cli/commands.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/stop_signal.h"
#include "core/cli/text_outputs.h"
#include "core/cli/view_options.h"
#include "core/compare/comparison_report.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"

namespace sightline {
namespace {

struct CompareCommand {
  std::filesystem::path scene, cells, report, html, csv;
  std::vector<std::string> methods;
  std::string device = "opencl";
  DeviceOptions device_options;
  ViewOptions views;
  CompareOptions options;
  SceneLoadOptions load;
  bool spatial_splits = false;
};

CompareEvents statusEvents(StatusLine& status, const std::string& place, const StopSignal& stop) {
  CompareEvents events;
  events.bake = [&status, place](const ViewCell& cell, Method method, uint64_t seed, const BakeProgress& p) {
    status.show([&] {
      return fmt::format("{} {}  {} seed {}  {} rays  {:.2f} Mrays/s  PVS {}  {}", place, cell.name,
                         methodName(method), seed, shortCount(p.rays), double(p.rays) / p.seconds * 1e-6,
                         p.pvs_size, shortDuration(p.seconds));
    });
  };
  events.measure = [&status, place](const ViewCell& cell, const MeasureProgress& p) {
    status.show([&] {
      return fmt::format("{} {}  views {}/{}  {:.2f} Mrays/s  left {}", place, cell.name, p.views_done,
                         p.views, double(p.rays) / p.seconds * 1e-6,
                         shortDuration(p.seconds / p.views_done * (p.views - p.views_done)));
    });
  };
  events.stop = stop.flag();
  return events;
}

/// Compares on all cells; false if it was stopped. What is done by then is in the report.
bool compareCells(const Scene& scene, const std::vector<ViewCell>& cells, std::span<Device* const> by_method,
                  const StopSignal& stop, ComparisonReport& report) {
  StatusLine status;
  try {
    // Where seconds count, the first bake must not pay for what the driver does once.
    if (report.options.params.max_seconds > 0) {
      warmUp(by_method, scene, cells.front(), report.options, statusEvents(status, "warming up", stop));
    }
    for (uint32_t c = 0; c < cells.size(); ++c) {
      const std::string place = fmt::format("{}/{}", c + 1, cells.size());
      report.cells.push_back(
          compareCell(by_method, scene, cells[c], c, report.options, statusEvents(status, place, stop)));
      status.end();
      fmt::print("{} {} done\n", place, cells[c].name);
      std::fflush(stdout);
    }
  } catch (const Interrupted&) {
    status.end();
    fmt::print("stopped after {} of {} cells\n", report.cells.size(), cells.size());
    return false;
  }
  return true;
}

void saveReports(const CompareCommand& command, const ComparisonReport& report, const TextOutputs& outputs) {
  if (report.cells.empty()) return;
  std::fputs(("\n" + comparisonTable(report)).c_str(), stdout);
  for (const CellComparison& cell : report.cells) {
    for (const MethodRun& run : cell.runs) {
      if (run.points.back().state.size > 0) continue;
      fmt::print("{}, {}: no batch of rays ended within the budget; --n-rand makes them smaller\n",
                 cell.cell.name, methodName(run.method));
    }
  }
  if (!command.report.empty()) outputs.save(comparisonJson(report), command.report);
  if (!command.csv.empty()) outputs.save(comparisonCsv(report), command.csv);
  if (!command.html.empty()) outputs.save(comparisonPage(report).html(), command.html);
}

void run(const CompareCommand& command) {
  checkOptions(command.options);
  for (const Method method : command.options.methods) requireMethodOn(method, command.device);
  const std::array reports = {command.report, command.html, command.csv};
  requireSeparate(reports, std::array{command.scene, command.cells});
  const TextOutputs outputs(reports);
  Session session(loadScene(command.scene, command.load), {.device = command.device,
                                                           .device_options = command.device_options,
                                                           .spatial_splits = command.spatial_splits});
  const Scene& scene = session.scene();
  const std::vector<ViewCell> cells = moved(loadCells(command.cells), -scene.offset);
  std::vector<Device*> by_method;
  for (const Method method : command.options.methods) by_method.push_back(&session.parts().device(method));

  ComparisonReport report;
  report.version = SL_VERSION;
  report.command = commandLine();
  report.scene = summarize(scene, command.scene.filename().string(), hashScene(scene));
  report.device = session.device();
  report.spatial_splits = command.spatial_splits;
  report.options = command.options;
  report.options.measure = chooseViews(command.views, report.device.on_cpu, command.options.measure);
  fmt::print("{}: {} triangles, {}; {}, {}; {} views of {} x {} pixels a cell\n", command.scene.string(),
             scene.triangleCount(), counted(cells.size(), "cell"), report.device.id, report.device.name,
             report.options.measure.views, report.options.measure.resolution,
             report.options.measure.resolution);
  StopSignal stop;
  report.complete = compareCells(scene, cells, by_method, stop, report);
  saveReports(command, report, outputs);
  if (!report.complete) throw ExitCode{stop.exitCode()};
}

void declareFiles(CLI::App& command, CompareCommand& options) {
  command.add_option("scene", options.scene, ".obj, .gltf, .glb or .ply")->required()->type_name("SCENE");
  command.add_option("--cells", options.cells, "view cells, JSON")->required()->type_name("CELLS.json");
  command
      .add_option("--report", options.report,
                  "write everything as JSON (docs/report.md); - is standard output, here and below")
      ->type_name("R.json");
  command.add_option("--csv", options.csv, "write the points of the budget as CSV")->type_name("R.csv");
  command.add_option("--html", options.html, "write a page with tables and charts")->type_name("R.html");
  declareLoading(command, options.load);
}

void declareComparison(CLI::App& command, CompareCommand& options) {
  CompareOptions& compare = options.options;
  command.add_option("--methods", options.methods, "methods to compare (default: gvs++,gvs,random)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(oneOf(bakeMethods()))
      ->type_name("NAME,...");
  command.add_option("--rays", compare.params.max_rays, "budget of a cell: so many rays")
      ->transform(wholeNumber(1, 1'000'000'000'000'000'000))
      ->type_name("N");
  command.add_option("--seconds", compare.params.max_seconds, "budget of a cell: so many seconds")
      ->check(between(1e-6, 1e9))
      ->type_name("S");
  command
      .add_option("--repeats", compare.repeats,
                  "bakes of each cell and method, with seeds that follow --seed")
      ->transform(wholeNumber(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option("--points", compare.points,
                  "measure the pixel error at the whole budget, half of it, a quarter ...")
      ->transform(wholeNumber(1, 40))
      ->type_name("N")
      ->capture_default_str();
  command.add_option("--missing-rays", compare.missing_rays, "rays that measure the share of missing rays")
      ->transform(wholeNumber(1, 1u << 30))
      ->type_name("N")
      ->capture_default_str();
  declareViews(command, options.views);
}

constexpr const char* kCompareFooter =
    "Example:\n"
    "  sightline compare city.glb --cells cells.json --methods gvs++,random \\\n"
    "      --rays 2M --n-rand 500k --views 20 --html methods.html\n";

}  // namespace

void addCompareCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("compare", "Compare methods at equal budgets: sets, missing rays and pixel error");
  const auto options = std::make_shared<CompareCommand>();
  options->options.params.threshold = 0;
  declareFiles(*command, *options);
  declareComparison(*command, *options);
  declareMachine(*command, options->device, options->device_options, options->spatial_splits);
  declareSampling(*command, options->options.params);
  command->footer(kCompareFooter);
  command->callback([command, options] {
    CompareOptions& compare = options->options;
    if (command->count("--rays") + command->count("--seconds") == 0) {
      throw CLI::ValidationError("compare", "give a budget: --rays N or --seconds S");
    }
    requireDistinct("--methods", options->methods);
    if (!options->methods.empty()) compare.methods.clear();
    for (const std::string& name : options->methods) compare.methods.push_back(*methodOf(name));
    // The budget ends a bake, so that all spend the same; only who asks for T gets it.
    if (command->count("--threshold") == 0) compare.params.threshold = 0;
    compare.seed = compare.params.seed;
    run(*options);
  });
}

}  // namespace sightline

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include "core/api/session_parts.h"
#include "core/bake/require_scene.h"
#include "core/bake/status_line.h"
#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/base/text.h"
#include "core/cli/command_line.h"
#include "core/cli/commands.h"
#include "core/cli/device_check.h"
#include "core/cli/doors_option.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/stop_signal.h"
#include "core/cli/text_outputs.h"
#include "core/cli/view_options.h"
#include "core/formats/load_scene.h"
#include "core/gvs/bake_cell.h"
#include "core/io/file_io.h"
#include "core/measure/measure_page.h"
#include "core/measure/worst_pictures.h"
#include "core/pvs/choose_cell.h"
#include "core/pvs/pvs_writer.h"

namespace sightline {
namespace {

struct MeasureCommand {
  std::filesystem::path scene, report, csv, html, pictures;
  std::vector<std::filesystem::path> pvs;
  std::vector<std::string> cells;
  std::string device = "opencl";
  ViewOptions views;
  MeasureOptions options;
  double max_average = std::numeric_limits<double>::infinity();
  double max_wrong = std::numeric_limits<double>::infinity();
  SceneLoadOptions load;
  DoorState doors = DoorState::kClosed;
};

/// How the cells that two files hold differ; empty: not at all.
std::string cellsDifference(const PvsFile& first, const PvsFile& other) {
  if (first.cells.size() != other.cells.size()) {
    return fmt::format("{} cells there, {} here", first.cells.size(), other.cells.size());
  }
  for (size_t i = 0; i < first.cells.size(); ++i) {
    const ViewCell &there = first.cells[i].cell, &here = other.cells[i].cell;
    if (there.name != here.name) return fmt::format("cell {} is {} there, {} here", i, there.name, here.name);
    if (there != here) return fmt::format("cell {} has another shape there", there.name);
  }
  return {};
}

/// The files, all of one scene and with the same cells.
std::vector<PvsFile> loadSets(const MeasureCommand& command, const Scene& scene) {
  std::vector<PvsFile> sets;
  for (const std::filesystem::path& file : command.pvs) {
    sets.push_back(loadFinishedCells(file));
    requireScene(sets.back(), scene, file);
    const bool other_doors = sets.back().doors != sets.front().doors && command.doors == DoorState::kOpen;
    if (other_doors || sets.back().see_through != sets.front().see_through) {
      throw Error(fmt::format(
          "{}: was baked with other objects than {} that open or hide nothing; measure the files one by one",
          file.string(), command.pvs.front().string()));
    }
    if (sets.back().cells.empty()) {
      throw Error(fmt::format("{}: holds no finished cell; go on with its bake", file.string()));
    }
    const std::string difference = cellsDifference(sets.front(), sets.back());
    if (difference.empty()) continue;
    throw Error(fmt::format("{}: holds other cells than {} ({}); measure the files one by one", file.string(),
                            command.pvs.front().string(), difference));
  }
  return sets;
}

/// Indices of the cells to measure.
std::vector<uint32_t> cellsToMeasure(const MeasureCommand& command, const PvsFile& pvs) {
  std::vector<uint32_t> indices;
  for (const std::string& name : command.cells) {
    const auto index = uint32_t(&chooseCell(pvs, name, command.pvs.front()) - pvs.cells.data());
    if (std::find(indices.begin(), indices.end(), index) == indices.end()) indices.push_back(index);
  }
  for (uint32_t i = 0; command.cells.empty() && i < pvs.cells.size(); ++i) indices.push_back(i);
  return indices;
}

/// The defaults that the device can afford.
void chooseSize(const MeasureCommand& command, MeasureReport& report) {
  const bool small = report.device.on_cpu;
  report.options = chooseViews(command.views, small, command.options);
  checkOptions(report.options);
  const bool chosen = !command.views.views && !command.views.resolution;
  fmt::print("{} views of {} x {} pixels a cell{}, field of view {:g} degrees, seed {}\n",
             report.options.views, report.options.resolution, report.options.resolution,
             chosen && small ? " (the defaults of a processor)" : "", report.options.fov,
             report.options.seed);
}

std::string statusText(const std::string& cell, size_t index, size_t cells, const MeasureProgress& p,
                       double seconds_before) {
  const double left = p.seconds / p.views_done * (p.views - p.views_done);
  const double mean = (seconds_before + p.seconds + left) / double(index + 1);
  return fmt::format("{} {}/{}  views {}/{}  {} rays  {:.2f} Mrays/s  left {}, all {}", cell, index + 1,
                     cells, p.views_done, p.views, shortCount(p.rays), double(p.rays) / p.seconds * 1e-6,
                     shortDuration(left), shortDuration(left + mean * double(cells - index - 1)));
}

/// What an earlier run drew of these cells would be taken for pictures of this one.
void removeOldPictures(const MeasureCommand& command, const PvsFile& pvs, std::span<const uint32_t> cells) {
  size_t removed = 0;
  for (const uint32_t cell : cells) {
    removed += removeWorstPictures(command.pictures, pvs.cells[cell].cell.name, cell);
  }
  if (removed > 0) {
    fmt::print("{}: {} pictures of an earlier run removed\n", command.pictures.string(), removed);
  }
}

/// One cell of all files.
void measureOne(const MeasureCommand& command, const Scene& scene, Tracer& tracer,
                const std::vector<PvsFile>& files, uint32_t cell, const MeasureCallback& progress,
                const std::atomic<bool>* stop, MeasureReport& report) {
  std::vector<RankedSet> sets;
  for (const PvsFile& file : files) {
    sets.push_back(rankedSet(file.cells[cell].triangles, scene.triangleCount()));
  }
  const ViewCell& view_cell = files.front().cells[cell].cell;
  const auto errors = measureCell(tracer, view_cell, cell, sets, report.options, progress, stop);
  report.rays += errors.front().by_prefix.front().pixels;
  for (size_t s = 0; s < files.size(); ++s) {
    const CellPvs& pvs = files[s].cells[cell];
    MeasuredCell measured{
        view_cell.name, pvs.triangles.size(), errors[s].by_prefix.front(), errors[s].worst_views, {}};
    if (!command.pictures.empty()) {
      const WorstPictures pictures{command.pictures, files.size() == 1, report.options};
      measured.pictures = pictures.draw(scene, tracer, pvs, cell, s, measured.worst_views);
    }
    report.sets[s].cells.push_back(std::move(measured));
  }
}

void measureAll(const MeasureCommand& command, const Scene& scene, Tracer& tracer,
                const std::vector<PvsFile>& files, std::span<const uint32_t> cells, const StopSignal& stop,
                MeasureReport& report) {
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  StatusLine status;
  try {
    for (size_t i = 0; i < cells.size(); ++i) {
      const double before = seconds();
      const auto show = [&](const MeasureProgress& p) {
        status.show(
            [&] { return statusText(files.front().cells[cells[i]].cell.name, i, cells.size(), p, before); });
      };
      measureOne(command, scene, tracer, files, cells[i], show, stop.flag(), report);
    }
  } catch (const Interrupted&) {
    report.complete = false;
  }
  status.end();
  report.seconds = seconds();
}

/// The pictures that were drawn, with what they show.
std::vector<ReportPicture> readPictures(const MeasureCommand& command, const MeasureReport& report) {
  std::vector<ReportPicture> pictures;
  for (const MeasuredSet& set : report.sets) {
    for (const MeasuredCell& cell : set.cells) {
      for (size_t i = 0; i < cell.pictures.size(); ++i) {
        const FileBytes bytes = readFile(command.pictures / cell.pictures[i]);
        pictures.push_back({{bytes.view().begin(), bytes.view().end()}, worstViewCaption(set, cell, i)});
      }
    }
  }
  return pictures;
}

void run(const MeasureCommand& command) {
  checkOptions(command.options);
  std::vector<std::filesystem::path> inputs = command.pvs;
  inputs.push_back(command.scene);
  const std::array reports = {command.report, command.csv, command.html};
  requireSeparate(reports, inputs);
  const TextOutputs outputs(reports);
  if (!command.pictures.empty()) makeFolder(command.pictures);
  Scene loaded = loadScene(command.scene, command.load);
  std::vector<PvsFile> files = loadSets(command, loaded);
  Session session(inState(std::move(loaded), files.front(), command.doors), {.device = command.device});
  const Scene& scene = session.scene();
  for (size_t i = 0; i < files.size(); ++i) {
    files[i] = inState(std::move(files[i]), command.doors, command.pvs[i]);
  }
  const std::vector<uint32_t> cells = cellsToMeasure(command, files.front());
  Tracer& tracer = session.parts().tracer();

  MeasureReport report;
  report.version = SL_VERSION;
  report.scene = summarize(scene, command.scene.filename().string(), files.front().scene_hash);
  report.device = tracer.info();
  for (size_t s = 0; s < files.size(); ++s) {
    report.sets.push_back({command.pvs[s].string(), files[s].device, files[s].params, {}});
  }
  fmt::print("{}: {} triangles; {}, {}\n", command.scene.string(), scene.triangleCount(), report.device.id,
             report.device.name);
  chooseSize(command, report);
  if (!command.pictures.empty()) removeOldPictures(command, files.front(), cells);
  StopSignal stop;
  measureAll(command, scene, tracer, files, cells, stop, report);
  std::fputs(measureTable(report).c_str(), stdout);
  if (!report.complete) {
    fmt::print("stopped: {} of {} cells are measured\n", report.sets.front().cells.size(), cells.size());
  }
  fmt::print("{} rays in {}\n", shortCount(report.rays), shortDuration(report.seconds));
  if (!command.report.empty()) outputs.save(jsonText(measureJson(report)), command.report);
  if (!command.csv.empty()) outputs.save(measureCsv(report), command.csv);
  if (!command.html.empty())
    outputs.save(measurePage(report, readPictures(command, report), commandLine()).html(), command.html);
  if (stop.exitCode() != 0) throw ExitCode{stop.exitCode()};
  const auto past = pastLimits(report, command.max_average, command.max_wrong);
  for (const std::string& line : past) fmt::print("past the limit: {}\n", line);
  if (!past.empty()) throw ExitCode{kExitPastLimit};
}

void declareFiles(CLI::App& command, MeasureCommand& options) {
  command.add_option("scene", options.scene, "the scene that was baked")->required()->type_name("SCENE");
  command.add_option("pvs", options.pvs, "made by bake; several of the same cells are measured in one pass")
      ->required()
      ->type_name("OUT.pvs");
  command.add_option("--cell", options.cells, "measure only this cell, by name or index (default: all)")
      ->allow_extra_args(false)
      ->type_name("NAME|INDEX");
  command.add_option("--device", options.device, "as of bake")
      ->check(deviceName())
      ->type_name("NAME")
      ->capture_default_str();
  command
      .add_option("--pictures", options.pictures,
                  "draw the worst views, at most three a cell and file: scene grey, wrong pixels red; an "
                  "earlier run's pictures of these cells are removed")
      ->check(notStandardOutput("a folder of pictures"))
      ->type_name("DIR");
  command
      .add_option("--report", options.report,
                  "write what was found as JSON (docs/report.md); - is standard output, here and below")
      ->type_name("R.json");
  command.add_option("--csv", options.csv, "write it as CSV, a line a cell and file")->type_name("R.csv");
  command
      .add_option("--html", options.html,
                  "write a page with tables, a chart and the pictures, if there are any")
      ->type_name("R.html");
  declareLoading(command, options.load, kAsBakeDid);
  declareDoors(command, options.doors);
}

void declareMeasure(CLI::App& command, MeasureCommand& options) {
  declareViews(command, options.views);
  command.add_option("--fov", options.options.fov, "field of view, degrees")
      ->check(between(kSmallestFov, kLargestFov))
      ->type_name("DEGREES")
      ->capture_default_str();
  command.add_option("--seed", options.options.seed, "seed of the views")
      ->transform(wholeNumber())
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option("--max-average", options.max_average, "wrong pixels a view, on average over a cell's views")
      ->check(between(0, 1e18))
      ->type_name("X")
      ->group("Limits of any one cell and file (else exit code 3)");
  command.add_option("--max-wrong", options.max_wrong, "wrong pixels in any one view")
      ->transform(wholeNumber(0, 1'000'000'000'000'000'000))
      ->type_name("N")
      ->group("Limits of any one cell and file (else exit code 3)");
}

constexpr const char* kMeasureFooter =
    "Examples:\n"
    "  sightline measure city.glb city.pvs\n"
    "  sightline measure city.glb city.pvs --cell 0 --views 50 --pictures worst \\\n"
    "      --csv - | sort -t , -k 3\n";

}  // namespace

void addMeasureCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "measure", "Measure the pixel error: how much of what a cell sees is missing from its set");
  const auto options = std::make_shared<MeasureCommand>();
  declareFiles(*command, *options);
  declareMeasure(*command, *options);
  command->footer(kMeasureFooter);
  command->callback([options] { run(*options); });
}

}  // namespace sightline

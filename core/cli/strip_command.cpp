#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <memory>

#include "core/api/bake.h"
#include "core/api/session_parts.h"
#include "core/bake/progress.h"
#include "core/bake/require_scene.h"
#include "core/bake/status_line.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/bake_options.h"
#include "core/cli/commands.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/overwrite.h"
#include "core/cli/stop_signal.h"
#include "core/device/registry/device_names.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/gvs/bake_cell.h"
#include "core/io/file_io.h"
#include "core/place/outside_cells.h"
#include "core/pvs/cell_summary.h"
#include "core/pvs/missing_bound.h"
#include "core/pvs/pvs_writer.h"
#include "core/strip/aimed_rays.h"
#include "core/strip/lost_rays.h"
#include "core/strip/strip_scene.h"

namespace sightline {
namespace {

struct StripArguments {
  std::filesystem::path scene, out;
  std::string from = "outside";
  StripOptions strip;
  SceneLoadOptions load;
  uint32_t rays = 0, check_rays = 1'000'000;  ///< of each cell
  uint32_t aimed = 500;                       ///< of each cell at each triangle
  bool tight = false;
  std::string device = "opencl";
  DeviceOptions device_options;
  bool spatial_splits = false;
  BakeParams params;
};

/// Rounds of aimed rays at most.
constexpr uint32_t kMostRounds = 4;

bool isSets(const std::filesystem::path& from) {
  const std::string extension = lowerExtension(from);
  return extension == ".pvs" || extension == ".part";
}

SessionOptions sessionOf(const StripArguments& arguments) {
  return {.device = arguments.device,
          .device_options = arguments.device_options,
          .spatial_splits = arguments.spatial_splits,
          .scene_name = arguments.scene.filename().string()};
}

/// Bakes the cells. Throws ExitCode if it is stopped.
PvsFile bakeSets(const StripArguments& arguments, const std::vector<ViewCell>& cells, Session& session) {
  const StopSignal stop;
  ProgressPrinter printer(stdout, terminalColumns(stdout), cells);
  BakeEvents events;
  events.stop = stop.flag();
  events.progress = [&](uint32_t index, const BakeProgress& progress) { printer.progress(index, progress); };
  events.cell_done = [&](uint32_t index, const CellPvs& pvs) { printer.cellDone(index, summarize(pvs)); };
  PvsFile pvs = bake(session, cells, arguments.params, events);
  if (pvs.cells.size() == cells.size()) return pvs;
  printer.breakLine();
  fmt::print("stopped: nothing is written\n");
  throw ExitCode{stop.exitCode()};
}

PvsFile loadSets(const StripArguments& arguments, const Scene& scene) {
  PvsFile pvs = loadFinishedCells(arguments.from);
  requireScene(pvs, scene, arguments.from);
  if (pvs.cells.size() == pvs.planned.size()) return pvs;
  throw Error(fmt::format("{}: holds {} of {} cells; finish the bake first: what the others see would go",
                          arguments.from, pvs.cells.size(), pvs.planned.size()));
}

PvsFile setsOf(const StripArguments& arguments, Session& session) {
  if (isSets(arguments.from)) return loadSets(arguments, session.scene());
  return bakeSets(arguments,
                  arguments.from == "outside"
                      ? moved(outsideCells(sceneBounds(session.scene())), session.scene().offset)
                      : loadCells(arguments.from),
                  session);
}

/// In whichever state the doors of the bake are.
std::vector<bool> seenOf(const PvsFile& pvs) {
  std::vector<bool> seen(pvs.triangle_count, false);
  for (const CellPvs& cell : pvs.cells) {
    for (const uint32_t id : cell.triangles) seen[id] = true;
    if (!cell.open) continue;  // what open doors show stays, too
    for (const uint32_t id : cell.open->triangles) seen[id] = true;
  }
  return seen;
}

/// What the bake promises, a line a cell: as far as that goes, nothing that is seen goes.
void sayPromise(const PvsFile& pvs) {
  for (const CellPvs& cell : pvs.cells) {
    const CellSummary summary = summarize(cell);
    fmt::print("{}: sees {} triangles", cell.cell.name, summary.pvs_size);
    if (cell.stats.validation_rays == 0) {
      fmt::print("; not measured\n");
    } else {
      fmt::print("; {} of {} fresh rays meet others first: at most {:.2g} in a million, 95 % confidence\n",
                 cell.stats.missing_rays, shortCount(cell.stats.validation_rays),
                 summary.missingBound() * 1e6);
    }
  }
}

std::string megabytes(uint64_t bytes) {
  return fmt::format("{:.2f} MiB", double(bytes) / 0x1p20);
}

void sayResult(const StripArguments& arguments, const Scene& scene, const StripReport& report) {
  const uint64_t before = scene.triangleCount();
  fmt::print("{}: {} of {} triangles ({:.1f} %), {} of {}\n", arguments.out.string(), report.triangles,
             before, 100 * double(report.triangles) / double(before), megabytes(report.bytes),
             megabytes(report.bytes_before));
  for (const auto& buffer : report.buffers) fmt::print("{}: its buffer\n", buffer.string());
  fmt::print("{} went; of {} objects, {} with all that they have\n",
             counted(before - report.triangles, "triangle"), scene.objects.size(), report.objects_gone);
  for (const std::string& note : report.notes) fmt::print("note: {}\n", note);
}

/// Says how far tracing is that goes through all cells; ends with Ctrl-C.
class TraceStatus {
 public:
  TraceStatus(const char* what, size_t cells) : what_(what), cells_(cells) {}
  RayProgress of(size_t cell) {
    return [this, cell](uint64_t rays) {
      status_.show([&] {
        return fmt::format("{}: cell {} of {}, {} rays", what_, cell + 1, cells_, shortCount(rays));
      });
      return !stopped();
    };
  }
  bool stopped() const { return stop_.exitCode() != 0; }
  /// Ends the line. Throws ExitCode if it was stopped.
  void end() {
    status_.end();
    if (stopped()) throw ExitCode{stop_.exitCode()};
  }

 private:
  const char* what_;
  size_t cells_;
  StopSignal stop_;
  StatusLine status_;
};

/// What --rays see, too.
void addSeen(const StripArguments& arguments, const PvsFile& pvs, Session& session, std::vector<bool>& seen) {
  if (arguments.rays == 0) return;
  TraceStatus status("rays", pvs.cells.size());
  uint64_t added = 0;
  for (uint32_t i = 0; i < pvs.cells.size() && !status.stopped(); ++i) {
    added += markSeen({session.scene(), session.parts().tracer()}, pvs.cells[i].cell, i,
                      arguments.params.seed, arguments.rays, seen, status.of(i));
  }
  status.end();
  fmt::print("rays: {} from each cell meet {} that the sets lack\n", shortCount(arguments.rays),
             counted(added, "triangle"));
}

uint64_t countOf(const std::vector<bool>& marked) {
  return uint64_t(std::count(marked.begin(), marked.end(), true));
}

/// What stays: what is seen and what borders on it, also by rays that are aimed at what else would go, again
/// and again until they find nothing.
std::vector<bool> keptOf(const StripArguments& arguments, const PvsFile& pvs, Session& session,
                         std::vector<bool> seen) {
  const auto keep = [&] { return arguments.tight ? seen : withNeighbours(session.scene(), seen); };
  std::vector<bool> kept = keep();
  const uint64_t before = countOf(seen);
  uint64_t last = arguments.aimed > 0 ? 1 : 0;
  AimedRays aimed{.seed = arguments.params.seed, .each = arguments.aimed};
  TraceStatus status("aimed rays", pvs.cells.size());
  for (; last > 0 && aimed.round < kMostRounds && !status.stopped(); ++aimed.round) {
    last = 0;
    for (uint32_t i = 0; i < pvs.cells.size() && !status.stopped(); ++i) {
      aimed.cell_index = i;
      last += markAimed({session.scene(), session.parts().tracer()}, pvs.cells[i].cell, aimed, kept, seen,
                        status.of(i));
    }
    kept = keep();
  }
  status.end();
  if (aimed.round > 0) {
    fmt::print(
        "aimed: {} of {} rays of each cell at each triangle that would go meet {} that the sets lack; the "
        "last "
        "{}\n",
        counted(aimed.round, "round"), arguments.aimed, counted(countOf(seen) - before, "triangle"),
        last == 0 ? "none that goes" : fmt::format("{} that would go", last));
  }
  if (!arguments.tight) {
    fmt::print("margin: {} stay because they share an edge with one that is seen\n",
               counted(countOf(kept) - countOf(seen), "triangle"));
  }
  return kept;
}

/// Reads the output back, and traces fresh rays in both scenes.
void check(const StripArguments& arguments, const PvsFile& pvs, Session& session) {
  if (arguments.check_rays == 0) return;
  SceneLoadOptions load = arguments.load;
  load.offset = session.scene().offset;
  Session stripped(loadScene(arguments.out, load), sessionOf(arguments));
  TraceStatus status("check", pvs.cells.size());
  uint64_t rays = 0;
  LostRays sum;
  for (uint32_t i = 0; i < pvs.cells.size() && !status.stopped(); ++i) {
    uint32_t of_cell = arguments.check_rays;
    const LostRays found = countLostRays({session.scene(), session.parts().tracer()},
                                         {stripped.scene(), stripped.parts().tracer()}, pvs.cells[i].cell, i,
                                         arguments.params.seed, of_cell, status.of(i));
    sum.lost += found.lost;
    sum.ties += found.ties;
    rays += of_cell;
  }
  fmt::print(
      "check: {} of {} fresh rays meet first what went: at most {:.2g} in a million, 95 % confidence\n",
      sum.lost, rays, missingUpperBound(sum.lost, rays) * 1e6);
  if (sum.ties != 0) {
    fmt::print("check: {} meet another triangle that is as near, up to rounding\n", counted(sum.ties, "ray"));
  }
  status.end();
}

void runStrip(const StripArguments& arguments) {
  checkParams(arguments.params);
  requireMethodOn(arguments.params.method, arguments.device);
  const bool outside = arguments.from == "outside";
  requireSeparate(
      std::array{arguments.out},
      std::array{arguments.scene, outside ? std::filesystem::path() : std::filesystem::path(arguments.from)});
  requireNew(arguments.out, arguments.strip.overwrite);
  requireStrippable(arguments.scene, arguments.out);
  SceneLoadOptions load = arguments.load;
  load.faces = true;
  Session session(loadScene(arguments.scene, load), sessionOf(arguments));
  const Scene& scene = session.scene();
  fmt::print("{}: {} triangles, {}\n", arguments.scene.string(), scene.triangleCount(),
             counted(scene.objects.size(), "object"));
  for (const std::string& warning : scene.warnings) fmt::print("warning: {}\n", warning);
  const PvsFile pvs = setsOf(arguments, session);
  sayPromise(pvs);
  std::vector<bool> seen = seenOf(pvs);
  addSeen(arguments, pvs, session, seen);
  seen = keptOf(arguments, pvs, session, std::move(seen));
  StripOptions options = arguments.strip;
  options.ignored_extensions = arguments.load.ignored_extensions;
  options.allow_external = arguments.load.allow_external;
  sayResult(arguments, scene, stripScene(scene, arguments.scene, seen, options, arguments.out));
  check(arguments, pvs, session);
}

constexpr const char* kStripFooter =
    "The output is the scene file itself, without the triangles that are seen from no\n"
    "cell; its folder must hold what the scene names beside it. --from outside: from\n"
    "anywhere outside of the scene's bounds. A triangle goes if no ray met it, nor\n"
    "any that shares an edge with it (--tight: if no ray met it). What a cell is said\n"
    "to miss, and the last line, is the promise; more rays (--aimed, --rays,\n"
    "--n-rand, a lower --threshold) tighten it.\n\n"
    "Examples:\n"
    "  sightline strip car.glb -o shell.glb\n"
    "  sightline strip level.glb -o walked.glb --from cells.json --compact\n"
    "  sightline strip level.obj -o walked.obj --from level.pvs --keep-objects\n"
    "  sightline strip car.glb -o sure.glb --rays 1G --check-rays 200M\n";

}  // namespace

void addStripCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("strip", "Write the scene's own file without the triangles that nobody can see");
  const auto a = std::make_shared<StripArguments>();
  command->add_option("scene", a->scene, ".obj, .gltf, .glb or .ply")->required()->type_name("SCENE");
  command->add_option("-o,--output", a->out, "the file to write, of the scene's kind")
      ->required()
      ->check(notStandardOutput("a scene file"))
      ->type_name("OUT");
  command
      ->add_option("--from", a->from,
                   "who looks: outside, a cells file, or a bake of the scene, whose sets are taken")
      ->type_name("outside|CELLS.json|OUT.pvs")
      ->capture_default_str();
  command->add_flag("--keep-objects", a->strip.keep_objects, "keep a triangle of an object that nobody sees");
  command->add_flag("--compact", a->strip.compact, "drop the vertices that no triangle uses any more");
  command->add_flag("--overwrite", a->strip.overwrite, "replace the output if it is there");
  command
      ->add_option("--rays", a->rays,
                   "random rays of each cell besides the bake's; what they meet stays, too")
      ->transform(wholeNumber(0, 1u << 30))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--aimed", a->aimed,
                   "rays of each cell at each triangle that would go, in rounds until one finds nothing, "
                   "four at most; what "
                   "they meet stays; 0: none")
      ->transform(wholeNumber(0, 1u << 20))
      ->type_name("N")
      ->capture_default_str();
  command->add_flag("--tight", a->tight,
                    "drop triangles that share an edge with one that is seen, if no ray meets them");
  command
      ->add_option(
          "--check-rays", a->check_rays,
          "fresh rays of each cell that are traced in the scene and in the output, read back; 0: none")
      ->transform(wholeNumber(0, 1u << 30))
      ->type_name("N")
      ->capture_default_str();
  declareForeign(*command, a->load);
  declareMachine(*command, a->device, a->device_options, a->spatial_splits);
  declareSampling(*command, a->params);
  declareLimits(*command, a->params);
  command->footer(kStripFooter);
  command->callback([a] { runStrip(*a); });
}

}  // namespace sightline

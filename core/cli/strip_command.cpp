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
#include "core/pvs/door_state.h"
#include "core/pvs/missing_bound.h"
#include "core/pvs/pvs_writer.h"
#include "core/scene/seen_through.h"
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
  uint32_t rounds = 4;                        ///< of aimed rays at most
  bool tight = false;
  std::string device = "opencl";
  DeviceOptions device_options;
  bool spatial_splits = false;
  BakeParams params;
};

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

/// The scene as it stands in the file: what is written is made of that.
Scene loadWhole(const StripArguments& arguments) {
  SceneLoadOptions load = arguments.load;
  load.faces = true;
  try {
    return loadScene(arguments.scene, load);
  } catch (const Error& error) {
    // Other commands have an option that drops what is broken.
    const std::string message = error.what();
    const size_t option = message.find("; --repair");
    if (option == std::string::npos) throw;
    throw Error(message.substr(0, option) + "; mend the file first: strip copies it as it stands",
                error.exitCode());
  }
}

/// The scene in one state of the bake's doors, and what traces rays in it.
struct SceneState {
  DoorState doors;
  Session session;
  TracedScene traced() { return {session.scene(), session.parts().tracer()}; }
  const char* place() const { return doors == DoorState::kOpen ? " with the doors open" : ""; }
};

/// With the doors closed, and open where the bake has any. see_through, doors: of the bake, by the ids of
/// this scene.
std::vector<SceneState> statesOf(const StripArguments& arguments, Scene scene,
                                 const std::vector<NamedTriangles>& see_through,
                                 const std::vector<NamedTriangles>& doors) {
  scene = seenThrough(std::move(scene), see_through);
  std::optional<Scene> open;
  if (!doors.empty()) open = seenThrough(scene, doors);
  std::vector<SceneState> states;
  states.push_back({DoorState::kClosed, Session(std::move(scene), sessionOf(arguments))});
  if (open) states.push_back({DoorState::kOpen, Session(std::move(*open), sessionOf(arguments))});
  return states;
}

/// The sets that decide, and the scene in the states that they are of.
struct Viewed {
  PvsFile pvs;
  std::vector<SceneState> states;
  const Scene& scene() const { return states[0].session.scene(); }
};

Viewed viewedOf(const StripArguments& arguments, Scene scene) {
  Viewed viewed;
  if (isSets(arguments.from)) {
    viewed.pvs = loadSets(arguments, scene);
    viewed.states = statesOf(arguments, std::move(scene), viewed.pvs.see_through, viewed.pvs.doors);
    return viewed;
  }
  viewed.states = statesOf(arguments, std::move(scene), {}, {});
  viewed.pvs = bakeSets(arguments,
                        arguments.from == "outside"
                            ? moved(outsideCells(sceneBounds(viewed.scene())), viewed.scene().offset)
                            : loadCells(arguments.from),
                        viewed.states[0].session);
  return viewed;
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

void sayMissing(const CellStats& stats) {
  if (stats.validation_rays == 0) {
    fmt::print("; not measured\n");
    return;
  }
  fmt::print("; {} of {} fresh rays meet others first: at most {:.2g} in a million, 95 % confidence\n",
             stats.missing_rays, shortCount(stats.validation_rays),
             missingUpperBound(stats.missing_rays, stats.validation_rays) * 1e6);
}

/// What the bake promises, a line a cell: as far as that goes, nothing that is seen goes.
void sayPromise(const PvsFile& pvs) {
  for (const CellPvs& cell : pvs.cells) {
    fmt::print("{}: sees {} triangles", cell.cell.name, cell.triangles.size());
    sayMissing(cell.stats);
    if (!cell.open) continue;
    fmt::print("{}: with the doors open {} more", cell.cell.name, cell.open->triangles.size());
    sayMissing(cell.open->stats);
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
        return fmt::format("{}: cell {} of {}, {} rays{}", what_, cell + 1, cells_, shortCount(rays),
                           so_far_);
      });
      return !stopped();
    };
  }
  /// What the cells before gave, for the end of the line.
  void say(std::string so_far) { so_far_ = std::move(so_far); }
  bool stopped() const { return stop_.exitCode() != 0; }
  /// Takes the line away.
  void wipe() { status_.end(); }
  /// The same. Throws ExitCode if it was stopped.
  void end() {
    status_.end();
    if (stopped()) throw ExitCode{stop_.exitCode()};
  }

 private:
  const char* what_;
  size_t cells_;
  std::string so_far_;
  StopSignal stop_;
  StatusLine status_;
};

/// What --rays see, too.
void addSeen(const StripArguments& arguments, Viewed& viewed, std::vector<bool>& seen) {
  if (arguments.rays == 0) return;
  const std::vector<CellPvs>& cells = viewed.pvs.cells;
  for (SceneState& state : viewed.states) {
    TraceStatus status("rays", cells.size());
    uint64_t added = 0;
    for (uint32_t i = 0; i < cells.size() && !status.stopped(); ++i) {
      added += markSeen(state.traced(), cells[i].cell, i, arguments.params.seed, arguments.rays, seen,
                        status.of(i));
    }
    status.end();
    fmt::print("rays: {} from each cell{} meet {} that the sets lack\n", shortCount(arguments.rays),
               state.place(), counted(added, "triangle"));
  }
}

uint64_t countOf(const std::vector<bool>& marked) {
  return uint64_t(std::count(marked.begin(), marked.end(), true));
}

/// What stays: what is seen and what borders on it, also by rays that are aimed at what else would go, again
/// and again until they find nothing.
std::vector<bool> keptOf(const StripArguments& arguments, Viewed& viewed, std::vector<bool> seen) {
  const std::vector<CellPvs>& cells = viewed.pvs.cells;
  const auto keep = [&] { return arguments.tight ? seen : withNeighbours(viewed.scene(), seen); };
  std::vector<bool> kept = keep();
  const uint64_t before = countOf(seen);
  uint64_t last = arguments.aimed > 0 ? 1 : 0;
  AimedRays aimed{.seed = arguments.params.seed, .each = arguments.aimed};
  TraceStatus status("aimed rays", cells.size());
  for (; last > 0 && aimed.round < arguments.rounds && !status.stopped(); ++aimed.round) {
    last = 0;
    for (SceneState& state : viewed.states) {
      for (uint32_t i = 0; i < cells.size() && !status.stopped(); ++i) {
        aimed.cell_index = i;
        last += markAimed(state.traced(), cells[i].cell, aimed, kept, seen, status.of(i));
      }
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

/// Objects of the original scene by the ids of what is left of it; without those of which nothing is.
std::vector<NamedTriangles> leftOf(const std::vector<NamedTriangles>& objects,
                                   const std::vector<bool>& kept) {
  std::vector<NamedTriangles> left;
  const auto keptUntil = [&](uint32_t id) {
    return uint32_t(std::count(kept.begin(), kept.begin() + ptrdiff_t(id), true));
  };
  for (const NamedTriangles& object : objects) {
    const uint32_t first = keptUntil(object.first), end = keptUntil(object.first + object.count);
    if (end > first) left.push_back({object.name, first, end - first});
  }
  return left;
}

/// The output, read back.
Scene loadStripped(const StripArguments& arguments, const Scene& original, const StripReport& report) {
  SceneLoadOptions load = arguments.load;
  load.offset = original.offset;
  Scene scene = loadScene(arguments.out, load);
  if (scene.triangleCount() == report.triangles) return scene;
  throw Error(fmt::format("{}: read back, it holds {} triangles, not {}: do not use it",
                          arguments.out.string(), scene.triangleCount(), report.triangles));
}

/// Reads the output back, and traces fresh rays in both scenes, in one state of the doors after the other.
void check(const StripArguments& arguments, Viewed& viewed, const StripReport& report) {
  if (arguments.check_rays == 0) return;
  const std::vector<CellPvs>& cells = viewed.pvs.cells;
  std::vector<SceneState> stripped =
      statesOf(arguments, loadStripped(arguments, viewed.scene(), report),
               leftOf(viewed.pvs.see_through, report.kept), leftOf(viewed.pvs.doors, report.kept));
  // Where nothing of the doors is left, they are away in both of its states.
  for (SceneState& state : viewed.states) {
    SceneState& after = state.doors == DoorState::kOpen ? stripped.back() : stripped.front();
    TraceStatus status("check", cells.size());
    uint64_t rays = 0;
    LostRays sum;
    for (uint32_t i = 0; i < cells.size() && !status.stopped(); ++i) {
      uint32_t of_cell = arguments.check_rays;
      const LostRays found = countLostRays(state.traced(), after.traced(), cells[i].cell, i,
                                           arguments.params.seed, of_cell, status.of(i));
      sum.lost += found.lost;
      sum.ties += found.ties;
      rays += of_cell;
      status.say(fmt::format("; before: {} of {} meet what went", sum.lost, shortCount(rays)));
    }
    status.wipe();
    fmt::print(
        "check:{} {} of {} fresh rays meet first what went: at most {:.2g} in a million, 95 % "
        "confidence\n",
        state.place(), sum.lost, rays, missingUpperBound(sum.lost, rays) * 1e6);
    if (sum.ties != 0) {
      fmt::print("check: {} meet another triangle that is as near, up to rounding\n",
                 counted(sum.ties, "ray"));
    }
    status.end();
  }
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
  OutputFile probe(arguments.out);  // fail before the work, not after it
  Scene loaded = loadWhole(arguments);
  fmt::print("{}: {} triangles, {}\n", arguments.scene.string(), loaded.triangleCount(),
             counted(loaded.objects.size(), "object"));
  for (const std::string& warning : loaded.warnings) fmt::print("warning: {}\n", warning);
  Viewed viewed = viewedOf(arguments, std::move(loaded));
  sayPromise(viewed.pvs);
  std::vector<bool> seen = seenOf(viewed.pvs);
  addSeen(arguments, viewed, seen);
  seen = keptOf(arguments, viewed, std::move(seen));
  StripOptions options = arguments.strip;
  options.ignored_extensions = arguments.load.ignored_extensions;
  options.allow_external = arguments.load.allow_external;
  const StripReport report = stripScene(viewed.scene(), arguments.scene, seen, options, arguments.out);
  sayResult(arguments, viewed.scene(), report);
  check(arguments, viewed, report);
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
                   "rays of each cell at each triangle that would go, in rounds until one finds nothing; "
                   "what they meet stays; 0: none")
      ->transform(wholeNumber(0, 1u << 20))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--rounds", a->rounds,
                   "rounds of aimed rays at most: more keep more of what is hardly seen")
      ->transform(wholeNumber(1, 1u << 20))
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

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/bake/require_scene.h"
#include "core/bake/status_line.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/command_line.h"
#include "core/cli/commands.h"
#include "core/cli/device_check.h"
#include "core/cli/doors_option.h"
#include "core/cli/help_format.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/cli/stop_signal.h"
#include "core/cli/text_outputs.h"
#include "core/cli/whole_number.h"
#include "core/draw/make_camera.h"
#include "core/formats/load_scene.h"
#include "core/formats/walk_file.h"
#include "core/io/file_io.h"
#include "core/picture/png.h"
#include "core/pvs/choose_cell.h"
#include "core/pvs/pvs_writer.h"
#include "core/sampling/views.h"
#include "core/scene/scene_tree.h"
#include "core/walk/walk_page.h"
#include "core/walk/walk_pictures.h"

namespace sightline {
namespace {

constexpr const char* kAllMethods = "all";
constexpr std::string_view kViewsPath = "views:";

struct WalkCommand {
  std::filesystem::path scene, pvs, report, csv, html, pictures;
  std::string path;
  std::vector<std::string> methods{kAllMethods};
  std::string device = "vulkan", tracer = "cpu";
  std::string resolution = "1280x720";
  std::string check = kAllMethods, schedule = "live", outside = "all", chain = "barriers";
  uint32_t split = kDefaultSplit;
  uint32_t views = 200;
  std::optional<uint64_t> max_false;
  ReplayOptions options;
  bool no_tight = false, no_c_queue = false, no_batching = false, no_second_condition = false,
       no_multiqueries = false;
  SceneLoadOptions load;
  DoorState doors = DoorState::kClosed;
};

glm::uvec2 parseResolution(const std::string& text) {
  const size_t cross = text.find('x');
  const auto width = cross == std::string::npos ? std::nullopt : parseCount(text.substr(0, cross));
  const auto height = cross == std::string::npos ? std::nullopt : parseCount(text.substr(cross + 1));
  const auto fits = [](const std::optional<uint64_t>& side) {
    return side && *side >= 1 && *side <= kLargestImageSide;
  };
  if (!fits(width) || !fits(height)) {
    throw Error(fmt::format("--resolution: {} is not WIDTHxHEIGHT, each 1 to {}", text, kLargestImageSide),
                kExitUsage);
  }
  return {uint32_t(*width), uint32_t(*height)};
}

bool asksForAll(const WalkCommand& command) {
  return command.methods == std::vector<std::string>{kAllMethods};
}

/// Refuses what cannot be, before anything is loaded.
void checkMethods(const WalkCommand& command) {
  if (asksForAll(command)) return;
  requireDistinct("--methods", command.methods);
  for (const std::string& name : command.methods) {
    if (name == kAllMethods) throw Error("--methods: all stands alone", kExitUsage);
    if (walkMethod(name).needs_pvs && command.pvs.empty()) {
      throw Error(fmt::format("--methods: {} takes the sets of a bake: give it --pvs OUT.pvs", name),
                  kExitUsage);
    }
  }
}

/// The methods to replay; what `all` leaves out goes to report.left_out.
std::vector<std::string> chooseMethods(const WalkCommand& command, const WalkDevice& device,
                                       WalkReport& report) {
  std::vector<std::string> chosen;
  for (const WalkMethodInfo& info : walkMethods()) {
    const bool named = std::ranges::find(command.methods, info.name) != command.methods.end();
    if (!named && !asksForAll(command)) continue;
    std::string why = device.whyNot(info.name);
    if (info.needs_pvs && command.pvs.empty()) why = "it takes the sets of a bake (--pvs)";
    if (why.empty()) {
      chosen.push_back(info.name);
    } else if (named) {
      throw Error(fmt::format("{} cannot run on {}: {}", info.name, device.info().name, why));
    } else {
      report.left_out.push_back({info.name, why});
    }
  }
  for (const std::string& line : leftOutLines(report)) fmt::print("{}\n", line);
  return chosen;
}

/// The cells of --path views:CELL,...: by name or number; a name may hold commas itself.
std::vector<uint32_t> viewedCells(const WalkCommand& command, const PvsFile& pvs) {
  const std::string all = command.path.substr(kViewsPath.size());
  std::vector<std::string> names = {all};
  const bool one = std::ranges::any_of(pvs.cells, [&](const CellPvs& cell) { return cell.cell.name == all; });
  if (!one) names = CLI::detail::split(all, ',');
  requireDistinct("--path", names);
  std::vector<uint32_t> cells;
  for (const std::string& name : names) {
    cells.push_back(uint32_t(&chooseCell(pvs, name, command.pvs) - pvs.cells.data()));
  }
  return cells;
}

/// Views of cells, each a jump; or the walk's frames.
WalkFrames walkFrames(const WalkCommand& command, const PvsFile* pvs, const Scene& scene,
                      const AxisBox& bounds, glm::uvec2 size, WalkReport& report) {
  WalkFrames frames;
  const float near = nearDistance(bounds);
  if (command.path.starts_with(kViewsPath)) {
    report.fov = kDefaultFov;
    for (const uint32_t cell : viewedCells(command, *pvs)) {
      for (const ViewFrame& view : measureViews(pvs->cells[cell].cell, cell, command.views,
                                                command.options.method.schedule.seed, kDefaultFov)) {
        if (!frames.cameras.empty()) frames.cuts.push_back(uint32_t(frames.cameras.size()));
        frames.cameras.push_back(makeCamera(view, size.x, size.y, near));
        frames.cells.push_back(cell);
      }
    }
    return frames;
  }
  const CameraPath path = moved(loadWalk(command.path), -scene.offset);
  report.fov = path.fov;
  for (uint32_t frame = 0; frame < path.frames(); ++frame) {
    const PathPlace at = placeAt(path, frame);
    frames.cameras.push_back(
        makeCamera(lookAt(at.eye, at.look, path.fov, size.x, size.y), size.x, size.y, near));
  }
  frames.cuts = path.cuts;
  return frames;
}

/// The set, in the scene's coordinates. Throws Error.
PvsFile loadSet(const WalkCommand& command, const Scene& scene) {
  PvsFile pvs = loadFinishedCells(command.pvs);
  requireScene(pvs, scene, command.pvs);
  if (pvs.cells.empty()) {
    throw Error(fmt::format("{}: holds no finished cell; go on with its bake", command.pvs.string()));
  }
  return inState(std::move(pvs), command.doors, command.pvs);
}

std::string statusText(const ReplayProgress& p, double seconds) {
  const double left = p.done == 0 ? -1 : seconds / double(p.done) * double(p.all - p.done);
  return fmt::format("{}, {}: frame {} of {}, {} %, left {}", p.method, p.pass, p.frame, p.frames,
                     100 * p.done / std::max<uint64_t>(p.all, 1), shortDuration(left));
}

/// The frames in the middle of the first stretch between cuts and of the last.
std::vector<uint32_t> framesToShow(const WalkFrames& frames) {
  std::vector<uint32_t> shown;
  const std::vector<WalkStretch> stretches = stretchesOf(frames);
  for (const WalkStretch& s : {stretches.front(), stretches.back()}) {
    const uint32_t middle = s.begin + (s.end - s.begin) / 2;
    if (shown.empty() || shown.back() != middle) shown.push_back(middle);
  }
  return shown;
}

/// Draws pictures into the folder; those of what was drawn, of at most two methods.
WalkPictures drawPictures(const WalkCommand& command, const WalkScene& scene, Tracer& tracer,
                          const WalkReport& report) {
  WalkPictures pictures;
  const auto keep = [&](const Image& image, const std::string& name, const std::string& caption,
                        std::vector<ReportPicture>& into) {
    savePng(image, command.pictures / name);
    const FileBytes bytes = readFile(command.pictures / name);
    into.push_back({.png = {bytes.view().begin(), bytes.view().end()}, .caption = caption});
  };
  size_t shown = 0;
  for (const char* name : {"vfc", "opti-chc++", "hiz", "chc++", "chc", "pvs+vfc", "pvs"}) {
    const auto m = std::ranges::find(report.replay.methods, name, &MethodReplay::name);
    if (m == report.replay.methods.end() || m->drawn.empty() || shown == 2) continue;
    ++shown;
    for (size_t i = 0; i < m->drawn.size(); ++i) {
      const uint32_t frame = report.options.shown_frames[i];
      keep(drawnPicture(scene.scene, tracer, scene.draw.drawables, m->drawn[i], report.frames.cameras[frame]),
           fmt::format("drawn-{}-frame-{}.png", m->name, frame),
           fmt::format("{}, frame {}: {} of {}", m->name, frame, counted(m->drawn[i].size(), "object"),
                       scene.draw.drawables.list.size()),
           pictures.drawn);
    }
  }
  for (const MethodReplay& m : report.replay.methods) {
    for (const FalseFrame& worst : m.worst) {
      keep(falsePicture(scene.scene, tracer, report.frames.cameras[worst.frame], worst.pixels),
           fmt::format("false-{}-frame-{}.png", m.name, worst.frame),
           fmt::format("{}, frame {}: {}", m.name, worst.frame, counted(worst.pixels.size(), "false pixel")),
           pictures.wrong);
    }
  }
  return pictures;
}

/// What an earlier run drew would be taken for pictures of this one.
void removeOldWalkPictures(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> old;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool ours = (name.starts_with("drawn-") || name.starts_with("false-")) && name.ends_with(".png") &&
                      name.find("-frame-") != std::string::npos;
    if (ours && entry.is_regular_file()) old.push_back(entry.path());
  }
  for (const std::filesystem::path& file : old) std::filesystem::remove(file);
}

ReplayOptions replayOptions(const WalkCommand& command) {
  ReplayOptions options = command.options;
  options.check = command.check == kAllMethods;
  options.method.schedule.fixed = command.schedule == "fixed";
  options.method.cells.outside = command.outside == "all"       ? OutsideCells::all
                                 : command.outside == "nearest" ? OutsideCells::nearest
                                                                : OutsideCells::error;
  ChcOptions& chc = options.method.chc;
  chc.tight_bounds = !command.no_tight;
  chc.c_queue = !command.no_c_queue;
  chc.batching = !command.no_batching;
  chc.late_issue = !command.no_second_condition;
  chc.multi_queries = !command.no_multiqueries;
  if (command.pictures.empty()) options.kept_frames = 0;
  return options;
}

void sayPartition(const WalkCommand& command, const Scene& scene, const Drawables& drawables) {
  fmt::print("{}: {} triangles in {}\n", command.scene.string(), scene.triangleCount(),
             counted(drawables.list.size(), "object"));
  if (drawables.list.size() == 1) {
    fmt::print("note: the scene is one object, which is drawn whole or not at all; {}\n",
               command.split == 0 ? "--split 2048 cuts it" : "--split with a lower number cuts it");
  }
}

/// Writes all that can be written; then throws what stood in the way of the first that could not. tracer: for
/// pictures.
void saveResults(const WalkCommand& command, const TextOutputs& outputs, const WalkReport& report,
                 const WalkScene& walk, Tracer* tracer) {
  std::exception_ptr failed;
  const auto attempt = [&](const auto& save) {
    try {
      save();
    } catch (const Error&) {
      if (!failed) failed = std::current_exception();
    }
  };
  WalkPictures pictures;
  if (!command.csv.empty()) attempt([&] { outputs.save(walkCsv(report), command.csv); });
  if (!command.report.empty()) attempt([&] { outputs.save(jsonText(walkJson(report)), command.report); });
  if (!command.pictures.empty() && report.replay.complete) {
    attempt([&] { pictures = drawPictures(command, walk, *tracer, report); });
  }
  if (!command.html.empty()) {
    attempt([&] { outputs.save(walkPage(report, pictures, commandLine()).html(), command.html); });
  }
  if (failed) std::rethrow_exception(failed);
}

/// How it ends: an error, exit code 3, or all is well.
void concludeWalk(const WalkCommand& command, const WalkReport& report, const StopSignal& stop) {
  if (!report.replay.problem.empty()) throw Error(report.replay.problem, report.replay.problem_code);
  if (stop.exitCode() != 0) {
    fmt::print("stopped: what is written is of the frames that were drawn\n");
    throw ExitCode{stop.exitCode()};
  }
  if (!command.max_false) return;
  const std::vector<std::string> past = pastFalse(report, *command.max_false);
  for (const std::string& line : past) fmt::print("past the limit: {}\n", line);
  if (!past.empty()) throw ExitCode{kExitPastLimit};
}

/// An option that was given and that nothing in this run takes, a line each.
void sayUnused(const CLI::App& given, const WalkCommand& command) {
  const auto say = [&](const char* option, const std::string& takers) {
    if (given.count(option) > 0) fmt::print("note: {} does nothing here: it is {}\n", option, takers);
  };
  const auto sayUnlessAny = [&](std::initializer_list<const char*> options,
                                std::vector<std::string> methods) {
    const bool any = asksForAll(command) || std::ranges::any_of(methods, [&](const std::string& name) {
                       return std::ranges::find(command.methods, name) != command.methods.end();
                     });
    for (const char* option : options) {
      if (!any) say(option, fmt::format("of {}", fmt::join(methods, ", ")));
    }
  };
  sayUnlessAny({"--batch", "--assume", "--no-multiqueries", "--no-tight"}, {"chc++", "opti-chc++"});
  sayUnlessAny({"--no-c-queue", "--no-batching", "--no-second-condition"}, {"opti-chc++"});
  if (command.schedule == "fixed") {
    sayUnlessAny({"--schedule"}, {"stop-and-wait", "chc", "chc++", "opti-chc++"});
  }
  std::vector<std::string> by_sets;
  for (const WalkMethodInfo& info : walkMethods()) {
    if (info.needs_pvs) by_sets.push_back(info.name);
  }
  const bool views = command.path.starts_with(kViewsPath);
  sayUnlessAny({"--outside"}, by_sets);
  if (command.pvs.empty() && asksForAll(command)) say("--outside", "of methods by sets (--pvs)");
  if (!views) sayUnlessAny({"--pvs"}, by_sets);
  if (command.pvs.empty()) say("--doors", "of sets (--pvs)");
  if (command.device == "cpu") say("--chain", "of Vulkan");
  if (!views) say("--views", "of --path views:CELL");
  const bool checks = command.check == kAllMethods;
  if (!checks) say("--trace-every", "of --check all");
  if (command.pictures.empty() && (!checks || command.options.trace_every == 0)) {
    say("--trace-device", "of traced frames and --pictures");
  }
}

void run(const CLI::App& given, const WalkCommand& command) {
  checkMethods(command);
  requireWalkDevice(command.device);
  const bool views = command.path.starts_with(kViewsPath);
  if (views && command.pvs.empty()) {
    throw Error("--path: views:CELL takes the cell of a bake: give it --pvs OUT.pvs", kExitUsage);
  }
  if (command.max_false && command.check != kAllMethods) {
    throw Error("--max-false: takes --check all", kExitUsage);
  }
  const glm::uvec2 size = parseResolution(command.resolution);
  const std::array reports = {command.report, command.csv, command.html};
  requireSeparate(reports,
                  std::array{command.scene, command.pvs, std::filesystem::path(views ? "" : command.path)});
  const TextOutputs outputs(reports);
  WalkReport report;
  report.version = SL_VERSION;
  report.path = views ? command.path : std::filesystem::path(command.path).filename().string();
  report.pvs = command.pvs.filename().string();
  report.width = size.x, report.height = size.y;
  report.split = command.split;
  report.chain = command.device == "cpu" ? "" : command.chain;
  report.options = replayOptions(command);
  sayUnused(given, command);

  Scene scene = loadScene(command.scene, command.load);
  std::optional<PvsFile> pvs;
  if (!command.pvs.empty()) {
    const PvsFile first = loadFinishedCells(command.pvs);
    pvs = loadSet(command, scene);
    scene = inState(std::move(scene), first, command.doors);
  }
  report.scene =
      summarize(scene, command.scene.filename().string(), pvs ? pvs->scene_hash : hashScene(scene));
  const DrawScene draw = makeDrawScene(scene, {.split = command.split});
  sayPartition(command, scene, draw.drawables);
  report.drawables = draw.drawables.list.size();
  std::optional<PvsUnits> units;
  if (pvs) units = makePvsUnits(*pvs, draw.drawables);
  report.frames = walkFrames(command, pvs ? &*pvs : nullptr, scene, boundsOf(draw.drawables), size, report);
  report.options.method.cells.of_frames = report.frames.cells;
  if (units) {
    for (size_t i = 0; i < units->cells.size(); ++i) {
      report.cells.push_back({units->cells[i].name, units->triangles.lists[i].ids.size()});
    }
  }
  if (!command.pictures.empty()) {
    makeFolder(command.pictures);
    report.options.shown_frames = framesToShow(report.frames);
  }
  const auto start = std::chrono::steady_clock::now();
  const WalkClock clock = [start] {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  };
  const WalkScene walk{scene, draw, units ? &*units : nullptr};
  const auto device =
      makeWalkDevice(command.device, walk, clock, {.semaphores = command.chain == "semaphores"});
  report.device = device->info();
  report.gpu_times = device->timesGpu();
  fmt::print("{}, {}; {} of {} x {} pixels, schedule {}, seed {}\n", report.device.id, report.device.name,
             counted(report.frames.cameras.size(), "frame"), size.x, size.y, command.schedule,
             report.options.method.schedule.seed);
  const std::vector<std::string> methods = chooseMethods(command, *device, report);
  std::optional<Bvh> bvh;
  std::unique_ptr<Tracer> tracer;
  const bool traces = report.options.check && report.options.trace_every > 0;
  if (traces || !command.pictures.empty()) {
    bvh = buildSceneTree(scene);
    tracer = makeTracer(command.tracer, scene, *bvh);
    if (traces) report.tracer = tracer->info().id;
  }
  if (!command.pictures.empty()) removeOldWalkPictures(command.pictures);
  StopSignal stop;
  StatusLine status;
  ReplayHooks hooks{
      .progress =
          [&](const ReplayProgress& p) { status.show([&] { return statusText(p, clock() / 1000); }); },
      .stop = stop.flag()};
  report.replay =
      replayWalk(*device, walk, report.frames, methods, report.options, tracer.get(), clock, hooks);
  status.end();
  std::fputs(walkTable(report).c_str(), stdout);
  for (const std::string& note : walkNotes(report)) fmt::print("warning: {}\n", note);
  saveResults(command, outputs, report, walk, tracer.get());
  concludeWalk(command, report, stop);
}

void declareFiles(CLI::App& command, WalkCommand& o) {
  command.add_option("scene", o.scene, "the scene")->required()->type_name("SCENE");
  command
      .add_option("--path", o.path,
                  "the camera's walk (made by path or scene); views:CELL,...: the views by which measure "
                  "looks out of "
                  "cells of --pvs")
      ->required()
      ->type_name("W.json");
  command.add_option("--methods", o.methods, "all, or names with commas between them; they are listed below")
      ->delimiter(',')
      ->type_name("M,...");
  command.add_option("--pvs", o.pvs, "sets of this scene, for the methods pvs, pvs+vfc and pvs+hiz")
      ->type_name("OUT.pvs");
  command
      .add_option("--device", o.device,
                  "what draws: vulkan, vulkan:INDEX, vulkan:PART-OF-NAME, or cpu, slowly")
      ->type_name("NAME")
      ->capture_default_str();
  command
      .add_option("--report", o.report, "write what was found as JSON (docs/walk.md); - is standard output")
      ->type_name("R.json");
  command.add_option("--csv", o.csv, "write times and counts as CSV, a line a method and frame")
      ->type_name("R.csv");
  command
      .add_option("--html", o.html, "write a page with tables, figures and the pictures, if there are any")
      ->type_name("R.html");
  command
      .add_option("--pictures", o.pictures,
                  "draw what was drawn, from above, and the worst false pixels, red; an earlier walk's "
                  "pictures there "
                  "are removed")
      ->check(notStandardOutput("a folder of pictures"))
      ->type_name("DIR");
  declareLoading(command, o.load);
  declareDoors(command, o.doors);
}

void declareReplay(CLI::App& command, WalkCommand& o) {
  const auto whole = [&](const char* name, uint32_t& value, const char* about, uint64_t low, uint64_t high) {
    command.add_option(name, value, about)
        ->transform(wholeNumber(low, high))
        ->type_name("N")
        ->capture_default_str();
  };
  command.add_option("--resolution", o.resolution, "of the frames")->type_name("WxH")->capture_default_str();
  whole("--repeats", o.options.repeats,
        "whole replays a method, of which times are medians; one more is dropped", 1, 1000);
  whole("--in-flight", o.options.in_flight, "frames under way at once: 1 shows latency, 2 throughput", 1, 4);
  command.add_option("--check", o.check, "all: compare every frame with one that draws everything; none")
      ->check(oneOf({"all", "none"}))
      ->capture_default_str();
  command
      .add_option("--max-false", o.max_false,
                  "false pixels of any method but late and those by sets, more end with exit code 3")
      ->transform(wholeNumber())
      ->type_name("N");
  whole("--trace-every", o.options.trace_every, "frames from one that is traced to the next; 0: none is", 0,
        kMostPathFrames);
  command.add_option("--trace-device", o.tracer, "what traces those and the pictures, as of measure")
      ->check(tracerName())
      ->type_name("NAME")
      ->capture_default_str();
  whole("--views", o.views, "views of each cell of --path views:CELL", 1, kMostPathFrames);
  command.add_option("--seed", o.options.method.schedule.seed, "of jitter and views")
      ->transform(wholeNumber())
      ->type_name("N")
      ->capture_default_str();
}

void declareCulling(CLI::App& command, WalkCommand& o) {
  ChcOptions& chc = o.options.method.chc;
  const char* group = "Culling";
  const auto whole = [&](const char* name, uint32_t& value, const char* about, uint64_t high) {
    command.add_option(name, value, about)
        ->transform(wholeNumber(0, high))
        ->type_name("N")
        ->capture_default_str()
        ->group(group);
  };
  whole("--split", o.split, "objects of more triangles are cut into parts of at most so many; 0: never",
        1u << 30);
  command
      .add_option("--schedule", o.schedule,
                  "live: answers arrive when the device has them; fixed: after so many steps, the same on "
                  "all devices")
      ->check(oneOf({"live", "fixed"}))
      ->capture_default_str()
      ->group(group);
  command
      .add_option(
          "--chain", o.chain,
          "what makes a submit wait for the one before it, on Vulkan: barriers, or semaphores besides")
      ->check(oneOf({"barriers", "semaphores"}))
      ->capture_default_str()
      ->group(group);
  whole("--batch", chc.batch_size, "hidden nodes that wait to be asked about together (chc++, opti-chc++)",
        1u << 20);
  whole("--assume", chc.assumed_frames, "frames for which what was seen counts as seen (likewise)", 1u << 20);
  const auto flag = [&](const char* name, bool& value, const char* about) {
    command.add_flag(name, value, about)->group(group);
  };
  flag("--no-multiqueries", o.no_multiqueries, "a query a node (likewise)");
  flag("--no-tight", o.no_tight, "ask about nodes' own boxes, not those below (likewise)");
  flag("--no-c-queue", o.no_c_queue, "ask about nodes of failed multiqueries at once (opti-chc++)");
  flag("--no-batching", o.no_batching, "a submit at each change from drawing to asking (opti-chc++)");
  flag("--no-second-condition", o.no_second_condition,
       "ask as soon as nothing is left to visit (opti-chc++)");
  command.add_option("--outside", o.outside, "what the methods by sets draw where the camera is in no cell")
      ->check(oneOf({"all", "nearest", "error"}))
      ->capture_default_str()
      ->group(group);
}

std::string walkFooter() {
  std::string text = "Methods:\n";
  for (const WalkMethodInfo& info : walkMethods()) text += helpEntry(info.name, info.about);
  return text +
         "\nEach method replays the whole walk, without a window; then, in a pass of its\n"
         "own, each frame's depth is compared with that of one that draws everything.\n\n"
         "Examples:\n"
         "  sightline walk city.glb --path walk.json --methods none,vfc,opti-chc++\n"
         "  sightline walk city.glb --path walk.json --pvs city.pvs --html walk.html \\\n"
         "      --pictures walk --max-false 0\n";
}

}  // namespace

void addWalkCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("walk", "Replay a camera's path by every culling method: times, counts, errors");
  const auto options = std::make_shared<WalkCommand>();
  declareFiles(*command, *options);
  declareReplay(*command, *options);
  declareCulling(*command, *options);
  command->footer(walkFooter());
  command->callback([options, command] { run(*command, *options); });
}

}  // namespace sightline

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "core/bake/report.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/device_check.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/rounding_option.h"
#include "core/crosscheck/difference.h"
#include "core/crosscheck/ray_answers.h"
#include "core/device/registry/make_device.h"
#include "core/formats/load_scene.h"
#include "core/io/float_text.h"
#include "core/scene/scene_tree.h"
#include "core/shared/ray.h"

namespace sightline {
namespace {

struct TraceCommand {
  std::filesystem::path scene;
  std::string from, along;
  std::vector<std::string> devices = {"cpu"};
  RoundingLimit rounding;
  SceneLoadOptions load;
  bool spatial_splits = false, json = false;
};

/// What all tracers take in scenes of up to 2^20 units (core/shared/box.h; Embree aborts near the end of
/// floats).
constexpr float kShortestDirection = 0x1p-60f, kLongestDirection = 0x1p60f;

vec3 parseVector(const std::string& text, const char* option) {
  const auto v = readVector(text);
  if (!v) {
    throw Error(
        fmt::format("{}: '{}' is not X,Y,Z; each is a decimal (-1.5), a hexadecimal float (0x1.8p+0) or "
                    "the 8 digits of a float's bits (0x3fc00000)",
                    option, text),
        kExitUsage);
  }
  if (std::isfinite(v->x) && std::isfinite(v->y) && std::isfinite(v->z)) return *v;
  throw Error(
      fmt::format("{}: '{}' is not finite in single precision: such a ray meets nothing", option, text),
      kExitUsage);
}

Ray parseRay(const TraceCommand& command) {
  const vec3 origin = parseVector(command.from, "--from"), direction = parseVector(command.along, "--along");
  const Ray ray{vec4(origin, 0), vec4(direction, 0)};
  if (!hasDirection(ray)) {
    throw Error(fmt::format("--along: '{}' is a direction of zero: such a ray meets nothing", command.along),
                kExitUsage);
  }
  const float largest = maxAbs3(direction);
  if (largest >= kShortestDirection && largest <= kLongestDirection) return ray;
  throw Error(fmt::format("--along: '{}' is too short or too long for tracers: its largest component must be "
                          "from 2^-60 to 2^60; scale it, and t with it",
                          command.along),
              kExitUsage);
}

void print(const RayAnswers& answers, const std::vector<std::string>& devices) {
  size_t width = 7;  // "exactly"
  for (const std::string& device : devices) width = std::max(width, device.size());
  const vec3 origin = xyz3(answers.ray.origin), direction = xyz3(answers.ray.direction);
  fmt::print("{:<{}}  {} along {}\n", "from", width, hexText(origin), hexText(direction));
  fmt::print("{:<{}}  {} along {}\n", "bits", width, bitsText(origin), bitsText(direction));
  fmt::print("{:<{}}  {}\n", "exactly", width, exactText(answers.exact, answers.exact_glass));
  for (size_t d = 0; d < devices.size(); ++d) {
    const Ruling& ruling = answers.rulings[d];
    fmt::print(
        "{:<{}}  {}: {}{}\n", devices[d], width, answerText(answers.hits[d], answers.glass[d]),
        verdictName(ruling.verdict),
        ruling.steps_beside > 0 ? fmt::format(", {:.2g} float steps beside it", ruling.steps_beside) : "");
  }
  if (!answers.legal()) {
    fmt::print("past the limit: what is missed or wrong is more than rounding\n");
  } else if (answers.differ()) {
    fmt::print("they differ, and each may: the ray passes within rounding of an edge, or there is a tie\n");
  }
}

Json toJson(const TraceCommand& command, const Scene& scene, const RayAnswers& answers,
            const std::vector<std::string>& devices) {
  Json json = {{"sightline", SL_VERSION},
               {"scene",
                {{"name", command.scene.filename().string()},
                 {"hash", hashText(hashScene(scene))},
                 {"triangles", scene.triangleCount()}}},
               {"rounding_steps", command.rounding.steps}};
  addAnswers(json, answers, devices);
  json["differ"] = answers.differ();
  json["legal"] = answers.legal();
  return json;
}

void run(const TraceCommand& command) {
  const Ray ray = parseRay(command);
  for (const std::string& name : command.devices) requireDevice(name);
  const Scene scene = loadScene(command.scene, command.load);
  const Bvh bvh = buildSceneTree(scene, {.spatial_splits = command.spatial_splits});
  std::vector<std::unique_ptr<Tracer>> devices;
  std::vector<Tracer*> pointers;
  std::vector<std::string> ids;
  for (const std::string& name : command.devices) {
    devices.push_back(makeTracer(name, scene, bvh));
    pointers.push_back(devices.back().get());
    ids.push_back(devices.back()->info().id);
  }
  const RayAnswers answers = askAll(Judge(scene, bvh), ray, pointers, command.rounding);
  if (command.json) {
    std::fputs(jsonText(toJson(command, scene, answers, ids)).c_str(), stdout);
  } else {
    print(answers, ids);
  }
  if (!answers.legal()) throw ExitCode{kExitPastLimit};
}

}  // namespace

void addTraceCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("trace", "Trace one ray on devices; an exact judge says what it meets");
  const auto options = std::make_shared<TraceCommand>();
  command->add_option("scene", options->scene, ".obj, .gltf, .glb or .ply")->required()->type_name("SCENE");
  command->add_option("--from", options->from, "where the ray begins")->required()->type_name("X,Y,Z");
  command->add_option("--along", options->along, "its direction; t counts in units of it")
      ->required()
      ->type_name("X,Y,Z");
  command->add_option("--devices", options->devices, "devices that answer")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(tracerName())
      ->type_name("A,B,...")
      ->default_str("cpu");
  declareRounding(*command, options->rounding);
  command->add_flag("--json", options->json, "print JSON (docs/report.md)");
  command->add_flag("--spatial-splits", options->spatial_splits, "trace the tree with spatial splits");
  declareLoading(*command, options->load);
  command->footer(
      "Numbers are decimals (-1.5), hexadecimal floats (0x1.8p+0), or the bits of\n"
      "floats (0x3fc00000). Exit code 0: every answer is right, if only up to rounding;\n"
      "3: one is missed or wrong.\n\n"
      "Example:\n"
      "  sightline trace city.glb --from 0,1.5,0 --along 0x3f800000,0,0.25 \\\n"
      "      --devices cpu,opencl\n");
  command->callback([options] {
    requireDistinct("--devices", options->devices);
    run(*options);
  });
}

}  // namespace sightline

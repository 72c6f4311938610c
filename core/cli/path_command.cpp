#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <memory>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/load_options.h"
#include "core/cli/number_checks.h"
#include "core/cli/overwrite.h"
#include "core/cli/points.h"
#include "core/formats/load_scene.h"
#include "core/formats/walk_file.h"
#include "core/io/file_io.h"
#include "core/scene/scene_tree.h"
#include "core/trace/cpu_tracer.h"

namespace sightline {
namespace {

struct PathArguments {
  std::filesystem::path scene, output;
  std::vector<std::string> through;
  PathThrough path;
  SceneLoadOptions load;
  bool overwrite = false;
};

/// A surface that the eye passes from a frame to the next.
struct Passage {
  uint32_t frame = 0;
  uint32_t triangle = 0;
};

std::vector<Passage> passagesOf(const Scene& scene, const CameraPath& path) {
  const Bvh bvh = buildSceneTree(scene);
  const CpuTracer tracer(scene, bvh);
  std::vector<Passage> passages;
  for (uint32_t frame = 0; frame + 1 < path.frames(); ++frame) {
    if (startsStretch(path, frame + 1)) continue;
    const glm::dvec3 eye = placeAt(path, frame).eye, step = placeAt(path, frame + 1).eye - eye;
    if (step == glm::dvec3(0)) continue;
    const Hit hit = tracer.trace({glm::vec4(glm::vec3(eye), 0), glm::vec4(glm::vec3(step), 0)});
    if (hit.triangle != kNoTriangle && hit.t <= 1) passages.push_back({frame, hit.triangle});
  }
  return passages;
}

void sayPassages(const Scene& scene, const std::vector<Passage>& passages) {
  if (passages.empty()) return;
  const Passage& first = passages.front();
  const auto object = std::ranges::find_if(scene.objects, [&](const SceneObject& o) {
    return first.triangle - o.first_triangle < o.triangle_count;
  });
  fmt::print("warning: the eye goes through surfaces {}, first after frame {}: triangle {} of {}\n",
             passages.size() == 1 ? "once" : fmt::format("{} times", passages.size()), first.frame,
             first.triangle, object == scene.objects.end() ? "no object" : object->name);
}

void run(const PathArguments& arguments) {
  std::vector<std::filesystem::path> inputs(arguments.through.begin(), arguments.through.end());
  inputs.push_back(arguments.scene);
  requireSeparate(std::array{arguments.output}, inputs);
  requireNew(arguments.output, arguments.overwrite);
  PathThrough wanted = arguments.path;
  wanted.points = readPoints(arguments.through, "--through");
  const CameraPath path = pathThrough(wanted);
  const TextOutputs outputs({&arguments.output, 1});
  const Scene scene = loadScene(arguments.scene, arguments.load);
  sayPassages(scene, passagesOf(scene, moved(path, -scene.offset)));
  outputs.save(walkText(path, arguments.output.string()), arguments.output);
  fmt::print("{}: {}, {}\n", arguments.output.string(), counted(path.frames(), "frame"),
             counted(path.cuts.size(), "cut"));
}

constexpr const char* kPathFooter =
    "The camera goes along straight lines through the points, at an even speed, looks\n"
    "ahead and turns near them; the scene is searched for what it would go through.\n"
    "At a cut it jumps: the line between two points on which it would be is left out.\n"
    "A file of points has x,y,z on each line; # starts a comment.\n\n"
    "walk replays the file, cells --walk places view cells along it. To edit it:\n"
    "  {\"fov\":60,\"keys\":[{\"frame\":0,\"eye\":[x,y,z],\"look\":[x,y,z]},...],\"cuts\":[...]}\n\n"
    "Examples:\n"
    "  sightline path city.glb -o walk.json --frames 3000 \\\n"
    "      --through 0,1.7,-200 0,1.7,200 120,1.7,200\n"
    "  sightline path city.glb -o walk.json --frames 600 --through points.txt \\\n"
    "      --cut 300\n";

}  // namespace

void addPathCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("path", "Make a camera's path through points, for walk");
  const auto a = std::make_shared<PathArguments>();
  command->add_option("SCENE", a->scene, "Scene file: .obj, .gltf, .glb or .ply")->required();
  command->add_option("-o,--output", a->output, "Walk file to write (.json), or - for standard output")
      ->required();
  command->add_option("--through", a->through, "Two points or more: x,y,z x,y,z ..., or a file")
      ->required()
      ->type_name("POINT");
  command->add_option("--frames", a->path.frames, "Of the whole path")
      ->required()
      ->transform(wholeNumber(2, kMostPathFrames))
      ->type_name("N");
  command->add_option("--fov", a->path.fov, "Field of view from top to bottom, degrees")
      ->check(between(kSmallestPathFov, kLargestPathFov))
      ->type_name("DEGREES")
      ->capture_default_str();
  command->add_option("--cut", a->path.cuts, "Frame at which the camera jumps; several: ascending")
      ->transform(wholeNumber(1, kMostPathFrames))
      ->type_name("N");
  command->add_flag("--overwrite", a->overwrite, "Replace the walk file if it is there");
  declareLoading(*command, a->load);
  command->footer(kPathFooter);
  command->callback([a] { run(*a); });
}

}  // namespace sightline

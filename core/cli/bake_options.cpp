#include "core/cli/bake_options.h"

#include <fmt/core.h>

#include <limits>
#include <map>

#include "core/cli/device_check.h"
#include "core/cli/free_side_option.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/gvs/thesis_params.h"

namespace sightline {
namespace {

constexpr uint64_t kMostRays = 1'000'000'000'000'000'000;
constexpr uint64_t kMostValidationRays = 1'000'000'000'000'000;
constexpr const char* kParamsGroup = "Parameters (they decide the result)";

void declareMethod(CLI::App& command, BakeParams& params) {
  command
      .add_option_function<std::string>(
          "--method", [&params](const std::string& name) { params.method = *methodOf(name); },
          "gvs++; gvs: the original, with fewer border and reverse rays; random: random rays alone; raster: "
          "drawn hemicubes, on vulkan only; naive: gvs++ with the set on the host, for comparison")
      ->check(oneOf(bakeMethods()))
      ->type_name("NAME")
      ->default_str(methodName(params.method))
      ->group(kParamsGroup);
}

template <typename Value>
void declareCount(CLI::App& command, const char* name, Value& value, uint64_t low, uint64_t high,
                  const char* help) {
  command.add_option(name, value, help)
      ->transform(wholeNumber(low, high))
      ->type_name("N")
      ->capture_default_str()
      ->group(kParamsGroup);
}

template <typename Value>
void declareNumber(CLI::App& command, const char* name, Value& value, const char* help) {
  command.add_option(name, value, help)
      ->check(between(0, double(std::numeric_limits<float>::max())))
      ->type_name("X")
      ->default_str(fmt::format("{}", value))
      ->group(kParamsGroup);
}

void declareLimits(CLI::App& command, BakeParams& params) {
  declareCount(command, "--max-rays", params.max_rays, 0, kMostRays,
               "stop a cell after so many rays (0: no limit)");
  declareNumber(command, "--max-seconds", params.max_seconds,
                "stop a cell after so many seconds (0: no limit)");
  command
      .add_option("--target-error", params.target_error,
                  "stop a cell when the share of wrong pixels is below E with 95 % confidence, instead of by "
                  "--threshold (docs/evaluation.md)")
      ->check(between(kSmallestTargetError, 0.999999))
      ->type_name("E")
      ->group(kParamsGroup);
  declareCount(command, "--validation-rays", params.validation_rays, 0, kMostValidationRays,
               "rays that measure what a cell missed");
}

}  // namespace

std::vector<std::string> bakeMethods() {
  return {"gvs++", "gvs", "random", "raster", "naive"};
}

void declareSampling(CLI::App& command, BakeParams& params) {
  // First: CLI11 takes options in the order of declaration, so any other wins over it.
  command
      .add_flag_callback(
          "--thesis", [&params] { setThesisParams(params); },
          "the thesis's samples, distances in world units (0.001, 0.985), order and stop rule; what is "
          "given beside it wins")
      ->group(kParamsGroup);
  declareCount(command, "--n-rand", params.n_rand, 1, 4'294'967'293, "random rays an iteration");
  declareCount(command, "--n-abs-edge", params.n_abs_edge, 0, 1000,
               "samples along each long edge of the border polygon at most");
  declareNumber(command, "--abs-spacing", params.abs_spacing,
                "fewer of them where they come closer to each other, in radians seen from the ray's origin "
                "(0: never)");
  declareCount(command, "--n-rs-edge", params.n_rs_edge, 0, 1000,
               "reverse samples along each edge of the cell's faces");
  declareCount(command, "--n-rs-area", params.n_rs_area, 0, 100000, "reverse samples on the cell's faces");
  declareCount(
      command, "--reverse-stride", params.reverse_stride, 1, std::numeric_limits<uint32_t>::max(),
      "of neighbouring border samples with the same occluder, reverse samples for the first and every "
      "N-th (1: for all)");
  command
      .add_option_function<std::string>(
          "--order", [&params](const std::string& name) { params.order = *orderOf(name); },
          "yield: the kind of ray that finds most goes first; queue: reverse rays of a batch follow its "
          "border rays, as in the thesis")
      ->check(oneOf({"yield", "queue"}))
      ->type_name("NAME")
      ->default_str(orderName(params.order))
      ->group(kParamsGroup);
  declareNumber(command, "--delta-abs", params.delta_abs,
                "border distance in world units (thesis: 0.001), added to");
  declareNumber(command, "--delta-abs-relative", params.delta_abs_relative,
                "border distance as a share of the distance");
  declareNumber(command, "--delta-rs", params.delta_rs, "discontinuity threshold in world units, added to");
  declareNumber(command, "--delta-rs-relative", params.delta_rs_relative,
                "discontinuity threshold as a share of the distance");
  declareCount(command, "--raster-resolution", params.raster_resolution, 16, 16384,
               "raster: pixels along an edge of a hemicube's front");
  declareCount(command, "--threshold", params.threshold, 0, std::numeric_limits<uint32_t>::max(),
               "T: a quiet iteration finds fewer new triangles");
  declareCount(command, "--quiet-iterations", params.quiet_iterations, 1, 1000000,
               "stop after so many of them in a row");
  declareCount(command, "--batch-rays", params.batch_rays, 4096, 1u << 28,
               "rays of a border or reverse batch at most");
  command.add_option("--seed", params.seed, "seed of the random rays, 0 to 2^64 - 1")
      ->transform(wholeNumber())
      ->type_name("N")
      ->capture_default_str()
      ->group(kParamsGroup);
}

void declareMachine(CLI::App& command, std::string& device, DeviceOptions& options, bool& spatial_splits) {
  static const std::map<std::string, SetKind> kSets = {
      {"auto", SetKind::kAuto}, {"array", SetKind::kArray}, {"hash", SetKind::kHash}};
  const auto group = [](CLI::Option* option) { option->group("Machine (same result)"); };
  group(command
            .add_option("--device", device,
                        "cpu, opencl or vulkan; the latter two also with :INDEX or :PART-OF-NAME")
            ->check(deviceName())
            ->type_name("NAME")
            ->capture_default_str());
  group(command.add_option("--threads", options.threads, "of the tree and of cpu; 0: all cores")
            ->transform(wholeNumber(0, 4096))
            ->type_name("N")
            ->capture_default_str());
  const auto setKind = [&options](const std::string& name) { options.set = kSets.at(name); };
  group(command.add_option_function<std::string>("--set", setKind, "how the set is kept")
            ->check(oneOf({"auto", "array", "hash"}))
            ->type_name("KIND"));
  group(command
            .add_option("--memory-budget", options.memory_budget_bytes,
                        "memory that the device may use, e.g. 4GB or 3.7GiB (0: what it reports)")
            ->transform(byteSize())
            ->type_name("BYTES"));
  group(command.add_flag("--spatial-splits", spatial_splits,
                         "slower build, faster rays in scenes of long triangles"));
}

constexpr const char* kBakeFooter =
    "Examples:\n"
    "  sightline bake city.glb --cells cells.json -o city.pvs\n"
    "  sightline bake city.glb --cells cells.json -o quick.pvs \\\n"
    "      --n-rand 1M --validation-rays 1M --html quick.html\n"
    "  sightline bake city.glb --cells cells.json -o sure.pvs --device cpu \\\n"
    "      --n-rand 1M --target-error 1e-3 --report - | grep error_bound\n\n"
    "A bake that was stopped goes on when the same command is given again. Whole\n"
    "numbers may be written as 1e6 or 10M (k, M, G, T: powers of 1000), bytes as 4GB\n"
    "or 3.7GiB (KiB, MiB, GiB: powers of 1024).\n\n"
    "See also: scene and cells, which make what bake reads; info, picture, measure\n"
    "and export, which read what it makes; devices, for --device.\n";

void declareOptions(CLI::App& command, BakeOptions& options) {
  command.add_option("scene", options.scene, ".obj, .gltf, .glb or .ply")->required()->type_name("SCENE");
  command.add_option("--cells", options.cells, "view cells, JSON")->required()->type_name("CELLS.json");
  command.add_option("-o,--output", options.out, "the result; .part is added until it is whole")
      ->required()
      ->check(notStandardOutput("a .pvs file"))
      ->type_name("OUT.pvs");
  command
      .add_option("--report", options.report,
                  "write what was done as JSON (docs/report.md); - is standard output, here and below")
      ->type_name("R.json");
  command
      .add_option("--html", options.html,
                  "write a page with tables, charts and the pictures, if there are any")
      ->type_name("R.html");
  command.add_option("--csv", options.csv, "write how the sets grew, a line a batch (docs/report.md)")
      ->type_name("R.csv");
  command.add_option("--pictures", options.pictures, "draw each cell from outside and from inside, as PNG")
      ->check(notStandardOutput("a folder of pictures"))
      ->type_name("DIR");
  command.add_flag("--witnesses", options.witnesses, "keep a ray for each triangle that hits it first");
  command.add_flag("--repair", options.repair, "drop broken triangles instead of refusing the scene");
  command.add_flag("--overwrite", options.overwrite, "replace a bake with other inputs");
  command.add_flag(
      "--strict-cells", options.strict_cells,
      "exit code 2, before the bake where it can be known, for a cell that there is a warning about");
  declareFreeSide(
      command, options.free_side,
      "for the warning of cells inside of solids: front, back (turned faces) or any (no warning)");
  declareMachine(command, options.device, options.device_options, options.spatial_splits);
  declareMethod(command, options.params);
  declareSampling(command, options.params);
  declareLimits(command, options.params);
  command.footer(kBakeFooter);
}

}  // namespace sightline

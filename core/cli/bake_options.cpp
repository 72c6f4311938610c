#include "core/cli/bake_options.h"

#include <map>

#include "core/cli/device_check.h"
#include "core/cli/free_side_option.h"
#include "core/cli/load_options.h"
#include "core/cli/name_checks.h"
#include "core/cli/number_checks.h"
#include "core/gvs/thesis_params.h"
#include "core/pvs/param_table.h"

namespace sightline {
namespace {

constexpr const char* kParamsGroup = "Parameters (they decide the result)";

CLI::Option* declareValue(CLI::App& command, const Param& param, const ParamField<Method>& field,
                          BakeParams& params) {
  return command
      .add_option_function<std::string>(
          optionOf(param),
          [&params, field](const std::string& name) { params.*field.member = *methodOf(name); }, param.help)
      ->check(oneOf(bakeMethods()))
      ->type_name("NAME")
      ->default_str(valueText(param, params));
}

CLI::Option* declareValue(CLI::App& command, const Param& param, const ParamField<Order>& field,
                          BakeParams& params) {
  return command
      .add_option_function<std::string>(
          optionOf(param),
          [&params, field](const std::string& name) { params.*field.member = *orderOf(name); }, param.help)
      ->check(oneOf({"yield", "queue"}))
      ->type_name("NAME")
      ->default_str(valueText(param, params));
}

template <typename Number>
CLI::Option* declareValue(CLI::App& command, const Param& param, const ParamField<Number>& field,
                          BakeParams& params) {
  CLI::Option* option = command.add_option(optionOf(param), params.*field.member, param.help);
  if constexpr (std::is_integral_v<Number>) {
    option->transform(wholeNumber(field.low, field.high))->type_name("N");
  } else {
    option->check(between(double(field.low), double(field.high)))->type_name("X");
  }
  const bool off = params.*field.member < field.low;  // its default is none that may be given
  return off ? option : option->default_str(valueText(param, params));
}

/// The option of a line of the table: name, range, default and help are what stands there.
CLI::Option* declareParam(CLI::App& command, BakeParams& params, const Param& param) {
  return std::visit([&](const auto& field) { return declareValue(command, param, field, params); },
                    param.field)
      ->group(kParamsGroup);
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
  for (const Param* param :
       {&paramOf("n_rand"), &paramOf("n_abs_edge"), &paramOf("abs_spacing"), &paramOf("n_rs_edge"),
        &paramOf("n_rs_area"), &paramOf("reverse_stride"), &paramOf("order"), &paramOf("delta_abs"),
        &paramOf("delta_abs_relative"), &paramOf("delta_rs"), &paramOf("delta_rs_relative"),
        &paramOf("raster_resolution"), &paramOf("threshold"), &paramOf("quiet_iterations"),
        &paramOf("batch_rays"), &paramOf("seed"), &paramOf("smallest_hole")}) {
    declareParam(command, params, *param);
  }
}

void declareLimits(CLI::App& command, BakeParams& params) {
  declareParam(command, params, paramOf("max_rays"));
  declareParam(command, params, paramOf("max_seconds"));
  declareParam(command, params, paramOf("target_error"))->type_name("E");
  declareParam(command, params, paramOf("validation_rays"));
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
  command
      .add_option(
          "--doors", options.doors,
          "objects that open, by name (* any letters, ? one; repeated): each cell also gets what it sees "
          "besides when they are open (docs/doors-and-gaps.md)")
      ->allow_extra_args(false)
      ->type_name("PATTERN");
  command
      .add_option("--see-through", options.see_through,
                  "objects that are seen but hide nothing, by name as above: the sets hold wherever they are")
      ->allow_extra_args(false)
      ->type_name("PATTERN");
  command.add_option("--bound", options.bound, paramOf("bound").help)->type_name("UPPER.pvs");
  command.add_flag("--witnesses", options.witnesses, "keep a ray for each triangle that hits it first");
  declareLoading(command, options.load);
  command.add_flag("--overwrite", options.overwrite, "replace a bake with other inputs");
  command.add_flag(
      "--strict-cells", options.strict_cells,
      "exit code 2, before the bake where it can be known, for a cell that there is a warning about");
  declareFreeSide(
      command, options.free_side,
      "for the warning of cells inside of solids: front, back (turned faces) or any (no warning)");
  declareMachine(command, options.device, options.device_options, options.spatial_splits);
  declareParam(command, options.params, paramOf("method"));
  declareSampling(command, options.params);
  declareLimits(command, options.params);
  command.footer(kBakeFooter);
}

}  // namespace sightline

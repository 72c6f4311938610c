#include "core/cli/load_options.h"

namespace sightline {

void declareLoading(CLI::App& command, SceneLoadOptions& options, const char* repair_help) {
  command.add_flag("--repair", options.repair, repair_help);
  command.add_flag(
      "--flatten", options.flatten,
      "write out meshes that many nodes show instead of tracing them as instances: the same sets, "
      "faster rays, more memory");
  declareForeign(command, options);
}

void declareForeign(CLI::App& command, SceneLoadOptions& options) {
  command
      .add_option("--ignore-extension", options.ignored_extensions,
                  "load a glTF file that requires this extension, without what it would add; repeatable")
      ->allow_extra_args(false)
      ->type_name("NAME");
  command.add_flag("--allow-external", options.allow_external,
                   "read files that the scene names, wherever they lie (default: its folder and below)");
}

}  // namespace sightline

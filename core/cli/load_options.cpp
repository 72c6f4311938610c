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
  command.add_flag("--opaque-masks", options.opaque_masks,
                   "take alpha masks of glTF as opaque, without a look at their textures");
  command.add_flag("--cull-back-faces", options.cull_back_faces,
                   "triangles that only have a front are not there from behind: those of glTF that are not "
                   "double-sided, all of OBJ and PLY");
}

}  // namespace sightline

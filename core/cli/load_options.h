#pragma once
#include <CLI/CLI.hpp>

#include "core/formats/load_scene.h"

namespace sightline {

/// Declares how a scene is read, alike in every command that reads one: --repair, --flatten, and what
/// declareForeign does. They write into `options`, which must live as long as `command`.
void declareLoading(CLI::App& command, SceneLoadOptions& options,
                    const char* repair_help = "drop broken triangles instead of refusing the scene");

/// --ignore-extension, --allow-external, --opaque-masks and --cull-back-faces alone, for a command that takes
/// no damaged scenes.
void declareForeign(CLI::App& command, SceneLoadOptions& options);

/// repair_help of commands that take a bake of the scene.
inline constexpr const char* kAsBakeDid = "load the scene as bake --repair did";

}  // namespace sightline

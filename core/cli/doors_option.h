#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "core/cli/name_checks.h"
#include "core/pvs/door_state.h"
#include "core/scene/seen_through.h"

namespace sightline {

/// Declares --doors of a command that reads a bake; `state` must live as long as `command`.
inline void declareDoors(CLI::App& command, DoorState& state) {
  command
      .add_option_function<std::string>(
          "--doors", [&state](const std::string& name) { state = *doorStateOf(name); },
          "the state of the doors of a bake with --doors: closed or open")
      ->check(oneOf({"closed", "open"}))
      ->type_name("STATE")
      ->default_str(doorStateName(DoorState::kClosed));
}

/// The scene as the bake saw it in this state of its doors.
inline Scene inState(Scene scene, const PvsFile& pvs, DoorState state) {
  scene = seenThrough(std::move(scene), pvs.see_through);
  return state == DoorState::kOpen ? seenThrough(std::move(scene), pvs.doors) : scene;
}

}  // namespace sightline

#pragma once
#include <optional>
#include <string>

#include "core/pvs/pvs_file.h"
#include "core/pvs/visible_from.h"

namespace sightline {

/// "closed" or "open".
std::string doorStateName(DoorState state);
/// The state of that name, if there is one.
std::optional<DoorState> doorStateOf(const std::string& name);

/// The cell with the set that it has in this state, and its witnesses; without an open set of its own. The
/// statistics stay those of the closed doors.
CellPvs inState(const CellPvs& cell, DoorState state);
/// All cells so, and no doors. Throws Error (wrong usage) for kOpen where the bake has no doors; file: for
/// the message.
PvsFile inState(PvsFile pvs, DoorState state, const std::filesystem::path& file);

}  // namespace sightline

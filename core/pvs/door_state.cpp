#include "core/pvs/door_state.h"

#include <fmt/core.h>

#include <algorithm>

namespace sightline {

std::string doorStateName(DoorState state) {
  return state == DoorState::kClosed ? "closed" : "open";
}

std::optional<DoorState> doorStateOf(const std::string& name) {
  for (const DoorState state : {DoorState::kClosed, DoorState::kOpen}) {
    if (doorStateName(state) == name) return state;
  }
  return {};
}

CellPvs inState(const CellPvs& cell, DoorState state) {
  CellPvs result;
  result.cell = cell.cell;
  result.stats = cell.stats;
  result.device = cell.device;
  if (state == DoorState::kClosed || !cell.open) {
    result.triangles = cell.triangles;
    result.witnesses = cell.witnesses;
    return result;
  }
  const OpenSet& open = *cell.open;
  for (size_t i = 0, k = 0; i < cell.triangles.size() || k < open.triangles.size();) {
    const bool closed =
        k == open.triangles.size() || (i < cell.triangles.size() && cell.triangles[i] < open.triangles[k]);
    result.triangles.push_back(closed ? cell.triangles[i] : open.triangles[k]);
    if (!cell.witnesses.empty() || !open.witnesses.empty()) {
      result.witnesses.push_back(closed ? cell.witnesses[i] : open.witnesses[k]);
    }
    ++(closed ? i : k);
  }
  return result;
}

PvsFile inState(PvsFile pvs, DoorState state, const std::filesystem::path& file) {
  if (state == DoorState::kOpen && pvs.doors.empty()) {
    throw Error(
        fmt::format("{}: was baked without doors, so there is nothing that opens; bake it with --doors",
                    file.string()),
        kExitUsage);
  }
  if (pvs.doors.empty()) return pvs;
  pvs.doors.clear();
  for (CellPvs& cell : pvs.cells) cell = inState(cell, state);
  return pvs;
}

}  // namespace sightline

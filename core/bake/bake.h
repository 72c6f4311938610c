#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/bake/bake_events.h"
#include "core/gvs/bake_cell.h"
#include "core/pvs/cell_summary.h"
#include "core/pvs/pvs_writer.h"

namespace sightline {

/// Bakes one cell: bakeCell on a device, or a fake in tests. Throws Error, Interrupted.
using CellBaker = std::function<CellPvs(const ViewCell& cell, uint32_t index, const ProgressCallback&)>;

/// How two bakes' inputs differ, for people: "scene (city.obj, 12 triangles, not room.obj, 10 triangles)",
/// "n_rand (1000, not 500)", ... Empty: a bake of one goes on with the other. The algorithm's revision and
/// the intersector count; the device does not: devices with one intersector give the same sets.
std::vector<std::string> inputDifferences(const PvsFile& earlier, const PvsFile& wanted);

/// Where a bake into `file` keeps its finished cells until all are there: FILE.part.
std::filesystem::path partFileOf(std::filesystem::path file);

/// The bake of many cells into one .pvs file, one cell after the other. Finished cells are kept in
/// "FILE.part" until all are there; the same bake again goes on after them.
class Bake {
 public:
  /// Looks at what is there: FILE complete, FILE.part to go on from, or nothing; locks the part file.
  /// wanted.cells is ignored. Throws Error if FILE or FILE.part holds cells of other inputs or is damaged,
  /// unless `overwrite` (which replaces them, but goes on after a part file with the same inputs), or if it
  /// cannot be read, or if nothing can be written there.
  Bake(PvsFile wanted, std::filesystem::path file, bool overwrite = false);

  /// FILE already holds everything.
  bool complete() const { return complete_; }
  /// Cells that are on the disk, in order.
  const std::vector<CellSummary>& finished() const { return finished_; }
  /// How many of them an earlier run left.
  size_t resumed() const { return resumed_; }
  /// What was wrong in the part file after these cells: what follows is baked again. Empty: nothing.
  const std::string& partProblem() const { return part_problem_; }
  /// Head of the file: inputs and planned cells; the device is the one on which the bake began.
  const PvsFile& head() const { return head_; }
  const std::filesystem::path& partFile() const { return part_; }

  /// Bakes what is missing and completes the file. False if *events.stop became true: what is finished is
  /// kept. device: on which the baker bakes, for the file. events.grown is the baker's.
  bool run(const std::string& device, const CellBaker& baker, const BakeEvents& events = {});

 private:
  bool openComplete();
  void goOnAfterPart(bool overwrite);

  PvsFile head_;
  std::filesystem::path file_, part_;
  std::unique_ptr<PvsWriter> writer_;
  std::vector<CellSummary> finished_;
  size_t resumed_ = 0;
  std::string part_problem_;
  bool complete_ = false;
  bool begun_ = false;
};

}  // namespace sightline

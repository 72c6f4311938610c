#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/shared/stage_params.h"
#include "core/shared/types.h"

namespace sightline {

/// Counters of the cell in work, read back after each stage.
struct DeviceCounters {
  uint64_t rays = 0;          ///< traced since beginCell
  uint64_t memory_bytes = 0;  ///< resident on the device now: scene, tree, set, queue, scratch
  bool hash_set = false;      ///< the set is a hash set, not an array
};

/// What a launch of border rays did.
struct BorderBatch {
  uint32_t entries = 0;          ///< whose border rays were traced
  uint32_t discontinuities = 0;  ///< appended
};

/// Runs the stages of GVS++ for one view cell at a time, with scene, set and queue resident. Every
/// implementation generates the same rays from core/shared and gives the same set, bit for bit.
///
///   beginCell -> { traceRandom* | traceBorder | traceReverse, then collect }* -> readPvs
///
/// A trace stage inserts the triangles it hits under their ray's index in the batch (1, 2, ...; the lowest
/// wins). collect closes the batch: it appends the new triangles, in ascending id, to the list.
/// Not thread-safe. All throw Error.
class CellSampler {
 public:
  virtual ~CellSampler() = default;

  /// Compiles the stages that bakes need, so that no cell's clock counts it; else each is at its first use.
  /// explores: border and reverse rays, too.
  virtual void prepare(bool explores, const StageParams& params) { (void)explores, (void)params; }

  /// Empties set, list and counters. faces: 1..6 as of cellFaces.
  virtual void beginCell(std::span<const Face> faces, const StageParams& params) = 0;

  /// Random rays of one segment (makeRandomSegment). Several segments may share a batch; their ray indices
  /// must not overlap.
  virtual void traceRandom(const RandomSegment& segment) = 0;

  /// Border rays of the list's entries from `first`: of as many blocks of kBorderBlock entries as have at
  /// most `most_rays` rays, one block at least; the list may end within the last. listing: appends the
  /// discontinuities that get reverse rays to the cell's list of them.
  virtual BorderBatch traceBorder(uint32_t first, uint32_t most_rays, bool listing) = 0;

  /// Reverse rays of the discontinuities first .. first + count - 1 of those appended since beginCell or
  /// dropDiscontinuities: reverseRayCount rays each at most.
  virtual void traceReverse(uint32_t first, uint32_t count) = 0;

  /// Empties the list of discontinuities. Their running numbers, which their reverse rays depend on, go on.
  virtual void dropDiscontinuities() = 0;

  /// Closes a batch; returns how many triangles were new. stage: kStage... of the batch.
  virtual uint32_t collect(uint32_t stage) = 0;

  /// Puts triangles into the set and list without rays (those that the cell contains), in the given order.
  /// None may be in the set yet, nor twice among them.
  virtual void insertContained(std::span<const uint32_t> triangles) = 0;

  /// Traces random rays with other shifts than the cell's, without inserting; returns how many hit a triangle
  /// outside the set.
  virtual uint64_t countMissing(const RandomSegment& segment, uvec4 shifts) = 0;

  virtual DeviceCounters counters() = 0;
  /// The whole list, in order of discovery.
  virtual std::vector<PvsEntry> readPvs() = 0;
};

}  // namespace sightline

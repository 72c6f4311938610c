#pragma once
#include <xxhash.h>

#include <filesystem>
#include <memory>

#include "core/pvs/byte_stream.h"
#include "core/pvs/pvs.h"

namespace sightline {

/// What a bake that was cut off left in its part file: everything up to the last whole cell.
struct PartialPvs {
  PvsFile pvs;               ///< ids and witnesses included
  uint64_t whole_bytes = 0;  ///< up to here the file is sound; 0: not even its head is there
  uint64_t torn_bytes = 0;   ///< after that: a cell that was being written, or damage
  std::string problem;       ///< what is wrong with them; empty: nothing, or the end is there already
};

/// Reads a part file. Throws Error if it cannot be read or is another kind or version of file.
PartialPvs loadPartialPvs(const std::filesystem::path& part);

/// loadPvs, or for a name that ends in ".part" the finished cells of a bake in work. Throws Error.
PvsFile loadFinishedCells(const std::filesystem::path& file);

/// Writes a .pvs file cell by cell. Cells are appended to a part file, each with its checksum and flushed
/// to the disk, so that a kill at any moment loses at most the cell in work; finish() completes the file and
/// renames it. All throw Error.
class PvsWriter {
 public:
  /// Opens the part file, or makes it, and locks it against a second writer; changes nothing in it.
  explicit PvsWriter(const std::filesystem::path& part);
  /// Removes the part file if nothing was ever written to it.
  ~PvsWriter();
  PvsWriter(const PvsWriter&) = delete;
  PvsWriter& operator=(const PvsWriter&) = delete;

  /// Starts over: cuts the part file to nothing and writes the head. head.cells is not written.
  void begin(const PvsFile& head);
  /// Goes on after what loadPartialPvs found; cuts off the torn rest.
  void goOn(const PartialPvs& left);
  /// Cells must come in the order planned, with witnesses if the head says so.
  void append(const CellPvs& cell);
  /// Ends the file and gives it its name.
  void finish(const std::filesystem::path& file);

 private:
  void write(const Bytes& bytes);

  std::filesystem::path part_;
  int descriptor_ = -1;
  uint32_t cells_ = 0;
  bool has_witnesses_ = false;
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> checksum_;
};

}  // namespace sightline

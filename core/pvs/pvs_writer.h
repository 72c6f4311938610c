#pragma once
#include <filesystem>
#include <vector>

#include "core/io/byte_stream.h"
#include "core/pvs/pvs_file.h"

namespace sightline {

/// Where some bytes of a file are.
struct ByteRange {
  uint64_t offset = 0;
  uint64_t size = 0;
};

/// What a bake that was cut off left in its part file: everything up to the last whole cell.
struct PartialPvs {
  PvsFile pvs;                    ///< ids and witnesses included
  std::vector<ByteRange> places;  ///< of the head with what is before it, then of each cell's CELL section
  uint64_t whole_bytes = 0;       ///< up to here the file is sound; 0: not even its head is there
  uint64_t torn_bytes = 0;        ///< after that: a cell that was being written, or damage
  std::string problem;            ///< what is wrong with them; empty: nothing, or the end is there already
};

/// Reads a part file. Throws BadPvs if it is another kind of file or another version of the format, Error if
/// it cannot be read.
PartialPvs loadPartialPvs(const std::filesystem::path& part);

/// The same for a file's content; `part` is its name, for messages.
PartialPvs parsePartialPvs(const Bytes& bytes, const std::filesystem::path& part);

/// loadPvs, or for a name that ends in ".part" the finished cells of a bake in work. Throws BadPvs, too where
/// not even its head is there, or Error.
PvsFile loadFinishedCells(const std::filesystem::path& file);

/// Writes a .pvs file cell by cell. Cells are appended to a part file, each with what it took and flushed
/// to the disk, so that a kill at any moment loses at most the cell in work; finish() puts the sections into
/// the order of a finished file and renames it. All throw Error.
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
  /// Writes the finished file beside the part file, which it then replaces, and gives it its name: until then
  /// there is a part file to go on from.
  void finish(const std::filesystem::path& file);

 private:
  void setHead(const PvsFile& head);
  void write(const Bytes& bytes);
  uint32_t cells() const { return uint32_t(places_.size() - 1); }
  void writeFinished(int descriptor, const std::filesystem::path& file) const;

  std::filesystem::path part_;
  int descriptor_ = -1;
  PvsFile head_;                   ///< as far as cells and costs depend on it
  uint64_t size_ = 0;              ///< of the part file
  std::vector<ByteRange> places_;  ///< in it, as PartialPvs has them
  ByteWriter costs_;               ///< payload of the finished file's COST section
};

}  // namespace sightline

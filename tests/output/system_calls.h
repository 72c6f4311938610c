#pragma once
#include <string>
#include <vector>

namespace sightline {

/// What the program under test asks of the system, in this executable: the calls stand in front of the C
/// library's own.
struct SystemCalls {
  /// fsync and rename since it was cleared, with names of files without their folder: "fsync x.txt.tmp7-0",
  /// "rename x.txt.tmp7-0 x.txt". A folder ends with "/".
  static std::vector<std::string> log;
  static bool reads_fail;  ///< every read answers that the disk is broken
};

}  // namespace sightline

#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sightline {

/// The chunks of a GLB file that mean something.
struct Glb {
  std::string_view json;
  std::string_view bin = {};               ///< without data if there is none
  std::vector<std::string> warnings = {};  ///< a line each
};

/// Views into `bytes`. Throws Error, which names `file`, if they are no whole GLB file of version 2. A total
/// length that is wrong although the chunks are whole, and a second chunk that is not marked as binary, are
/// warnings.
Glb splitGlb(std::string_view bytes, const std::string& file);

}  // namespace sightline

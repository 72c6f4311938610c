#pragma once
#include <string>
#include <string_view>

namespace sightline {

/// The chunks of a GLB file that mean something.
struct Glb {
  std::string_view json;
  std::string_view bin;  ///< without data if there is none
};

/// Views into `bytes`. Throws Error that names `file`.
Glb splitGlb(std::string_view bytes, const std::string& file);

}  // namespace sightline

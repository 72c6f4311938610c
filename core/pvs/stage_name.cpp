#include "core/pvs/stage_name.h"

namespace sightline {

std::string stageName(uint32_t stage) {
  constexpr const char* kNames[] = {"random", "border", "reverse", "contained"};
  return stage < 4 ? kNames[stage] : "unknown";
}

}  // namespace sightline

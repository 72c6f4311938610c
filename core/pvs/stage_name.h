#pragma once
#include <cstdint>
#include <string>

namespace sightline {

/// "random", "border", "reverse" or "contained".
std::string stageName(uint32_t stage);

}  // namespace sightline

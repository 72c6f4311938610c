#include "core/base/error.h"

#include <algorithm>

namespace sightline {
namespace {

std::string withoutControls(std::string line) {
  const auto isControl = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  std::replace_if(line.begin(), line.end(), isControl, '_');
  return line;
}

}  // namespace

Error::Error(const std::string& line, int exit_code, const std::string& log)
    : std::runtime_error(withoutControls(line) + (log.empty() ? "" : "\n" + log)), exit_code_(exit_code) {}

}  // namespace sightline

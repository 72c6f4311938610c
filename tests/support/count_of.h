#pragma once
#include <string>

namespace sightline::testing_support {

/// How often a text holds another.
inline size_t countOf(const std::string& text, const std::string& what) {
  size_t count = 0;
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

}  // namespace sightline::testing_support

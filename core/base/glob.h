#pragma once
#include <cstddef>
#include <string_view>

namespace sightline {

/// Whether a name as a whole is of the pattern, in which * stands for any letters, or none, and ? for one
/// byte. No time beyond the product of their lengths.
inline bool matchesGlob(std::string_view name, std::string_view pattern) {
  constexpr size_t kNone = std::string_view::npos;
  size_t n = 0, p = 0;
  size_t star = kNone, retried = 0;  // the last *, and where in the name what follows it was tried last
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      retried = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++n;
      ++p;
    } else if (star != kNone) {
      p = star + 1;
      n = ++retried;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace sightline

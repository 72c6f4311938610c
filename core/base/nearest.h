#pragma once
// "Did you mean": the name that a mistyped word stands for.
#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sightline {

/// Slips of the hand that turn a into b: a letter more, a letter less, another letter, two that changed
/// places.
// Based on: F. J. Damerau, A Technique for Computer Detection and Correction of Spelling Errors, 1964; no
// part of the word is changed twice.
inline size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<size_t> before, above,
      row(b.size() + 1);  // rows i - 2, i - 1 and i: distances of a's first i letters
  std::iota(row.begin(), row.end(), size_t(0));
  for (size_t i = 1; i <= a.size(); ++i) {
    before = std::exchange(above, row);
    row[0] = i;
    for (size_t k = 1; k <= b.size(); ++k) {
      const size_t other = above[k - 1] + (a[i - 1] == b[k - 1] ? 0 : 1);
      row[k] = std::min({above[k] + 1, row[k - 1] + 1, other});
      if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
        row[k] = std::min(row[k], before[k - 2] + 1);
    }
  }
  return row[b.size()];
}

/// The name nearest to the word, the first of equals; else the only one that begins with it. Upper and lower
/// case, and dashes before both, do not count. Empty: none is near, which is to say within a slip for every
/// three letters.
inline std::string nearestName(const std::string& word, std::span<const std::string> names) {
  const auto plain = [](const std::string& name) {
    std::string letters = name.substr(std::min(name.size(), name.find_first_not_of('-')));
    for (char& c : letters) {
      if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    }
    return letters;
  };
  const std::string wanted = plain(word);
  std::string nearest, beginning;
  size_t least = std::string::npos, beginnings = 0;
  for (const std::string& name : names) {
    const std::string letters = plain(name);
    const size_t distance = editDistance(wanted, letters);
    if (distance <= std::max(wanted.size(), letters.size()) / 3 && distance < least) {
      least = distance;
      nearest = name;
    }
    if (wanted.size() < 2 || !letters.starts_with(wanted)) continue;
    ++beginnings;
    beginning = name;
  }
  return nearest.empty() && beginnings == 1 ? beginning : nearest;
}

/// "; did you mean NAME?", or nothing where no name is near.
inline std::string didYouMean(const std::string& word, std::span<const std::string> names) {
  const std::string name = nearestName(word, names);
  return name.empty() ? name : "; did you mean " + name + "?";
}

}  // namespace sightline

#include "core/cli/points.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/base/error.h"

namespace sightline {

std::vector<double> parseNumbers(const std::string& text, const std::string& where) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value)) break;
    numbers.push_back(value);
    if (next == end) return numbers;
    if (*next != ',') break;
    at = next + 1;
  }
  throw Error(where + ": '" + text + "' is not numbers with commas between them, as in 1.5,0,-20",
              kExitUsage);
}

glm::dvec3 parsePoint(const std::string& text, const std::string& where) {
  const std::vector<double> numbers = parseNumbers(text, where);
  if (numbers.size() != 3) {
    throw Error(where + ": '" + text + "' has " + std::to_string(numbers.size()) + " numbers, expected x,y,z",
                kExitUsage);
  }
  return {numbers[0], numbers[1], numbers[2]};
}

std::vector<glm::dvec3> readPoints(const std::vector<std::string>& words, const std::string& option) {
  std::vector<glm::dvec3> points;
  for (const std::string& argument : words) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(argument, ignored)) {
      points.push_back(parsePoint(argument, option));
      continue;
    }
    std::ifstream file(argument);
    std::string line;
    for (uint64_t number = 1; std::getline(file, line); ++number) {
      std::istringstream in_line(line.substr(0, line.find('#')));
      for (std::string word; in_line >> word;) {
        points.push_back(parsePoint(word, argument + ":" + std::to_string(number)));
      }
    }
    if (!file.eof()) throw Error(argument + ": cannot be read");
  }
  return points;
}

}  // namespace sightline

#pragma once
#include <algorithm>
#include <cstddef>
#include <ostream>
#include <vector>

#include "core/measure/error_regions.h"

namespace sightline {

inline void PrintTo(const ImageError& e, std::ostream* out) {
  *out << e.wrong << " wrong, " << e.regions << " regions, largest " << e.largest_region;
}

namespace testing_support {

/// The error of an image, 1 where a pixel is wrong: flood fill over the 8 neighbours.
inline ImageError floodFill(std::vector<int> wrong, int side) {
  ImageError error;
  error.wrong = uint32_t(std::count(wrong.begin(), wrong.end(), 1));
  for (int start = 0; start < side * side; ++start) {
    if (wrong[size_t(start)] == 0) continue;
    ++error.regions;
    uint32_t size = 0;
    std::vector<int> open{start};
    wrong[size_t(start)] = 0;
    while (!open.empty()) {
      const int pixel = open.back();
      open.pop_back();
      ++size;
      for (int y = pixel / side - 1; y <= pixel / side + 1; ++y) {
        for (int x = pixel % side - 1; x <= pixel % side + 1; ++x) {
          if (x < 0 || y < 0 || x >= side || y >= side || wrong[size_t(y * side + x)] == 0) continue;
          wrong[size_t(y * side + x)] = 0;
          open.push_back(y * side + x);
        }
      }
    }
    error.largest_region = std::max(error.largest_region, size);
  }
  return error;
}

}  // namespace testing_support
}  // namespace sightline

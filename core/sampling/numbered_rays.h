#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/sampling/face_rays.h"
#include "core/shared/random_ray.h"

namespace sightline {

/// Random rays of a view cell by their number, in any order: the faces one after the other.
class NumberedRays {
 public:
  /// faces: of the cell (cellFaces); shifts: of haltonShifts; rays: how many there are, 1 .. 2^32 - 3.
  NumberedRays(std::vector<Face> faces, uvec4 shifts, uint32_t rays)
      : faces_(std::move(faces)), shifts_(shifts) {
    for (const uint32_t count : raysByArea(faces_, rays)) {
      ends_.push_back(count + (ends_.empty() ? 0 : ends_.back()));
    }
  }

  Ray at(uint32_t number) const {
    const auto face = std::upper_bound(ends_.begin(), ends_.end(), number) - ends_.begin();
    return randomRay(number, 0, faces_[size_t(face)], shifts_);
  }

 private:
  std::vector<Face> faces_;
  uvec4 shifts_;
  std::vector<uint32_t> ends_;
};

}  // namespace sightline

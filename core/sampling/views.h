#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cell/view_cell.h"
#include "core/shared/view_ray.h"

// Where the pixel error looks from, and where to (thesis 7.1).
namespace sightline {

/// Field of view of the images, degrees across and down.
inline constexpr double kDefaultFov = 90;
inline constexpr double kSmallestFov = 1, kLargestFov = 179;

/// All views of a cell by four numbers in [0, 1): uniform numbers give view points uniform over the cell's
/// surface. A flat cell looks along its normal. All other cells look in all directions, uniform over the
/// sphere, from every face: what is seen through the inside of the cell must be in its set, too. Horizons are
/// level (y is up) but for looks straight up or down.
class CellViews {
 public:
  explicit CellViews(const ViewCell& cell, double fov = kDefaultFov);

  ViewFrame at(const std::array<double, 4>& place) const;

 private:
  std::vector<Face> faces_;
  std::vector<double> areas_;  ///< sums: of the faces up to and with each
  bool flat_;
  double tangent_;  ///< of half the field of view
};

/// `count` views by the Halton sequence of four bases, its start random by seed and cell_index (the cell's
/// place in its file). The same on every run; the first views of a larger count are those of a smaller one.
std::vector<ViewFrame> measureViews(const ViewCell& cell, uint32_t cell_index, uint32_t count, uint64_t seed,
                                    double fov = kDefaultFov);

}  // namespace sightline

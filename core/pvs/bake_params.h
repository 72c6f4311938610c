#pragma once
#include <cstdint>

#include "core/pvs/method.h"
#include "core/pvs/order.h"

namespace sightline {

/// Parameters of a bake that decide its result (thesis 6.2.2, with its names). Same scene, cells, seed and
/// parameters: same sets, bit for bit.
struct BakeParams {
  Method method = Method::kGvspp;
  uint32_t n_rand = 10'000'000;  ///< random rays an iteration, 1 .. 2^32 - 3
  uint32_t n_abs_edge = 30;      ///< samples along each long edge of the border polygon, 0..1000: at most,
  float abs_spacing = 0x1p-11f;  ///< where they come closer than this to each other, seen from the ray's
                                 ///< origin in radians (0: never fewer)
  uint32_t n_rs_edge = 3;        ///< samples along each edge of the view cell's faces, 0..1000
  uint32_t n_rs_area = 4;        ///< samples on the view cell's faces, 0..100000
  uint32_t reverse_stride = 4;   ///< reverse samples for the first of neighbouring border samples with the
                                 ///< same occluder, and every so many-th; 1: for all
  Order order = Order::kYield;   ///< of gvs++ and naive
  float delta_abs_relative = 0x1p-17f;  ///< border distance, share of the distance from the ray's origin
  float delta_abs = 0;                  ///< border distance in world units (thesis: 0.001), added
  float delta_rs_relative = 0x1p-10f;   ///< discontinuity threshold, share of the distance
  float delta_rs = 0;                   ///< discontinuity threshold in world units, added
  uint32_t threshold = 10;              ///< T: stop after fewer new triangles in an iteration ...
  uint32_t quiet_iterations = 1;        ///< ... in this many iterations one after the other
  uint64_t max_rays = 0;                ///< stop a cell after so many rays (0: no limit)
  double max_seconds = 0;          ///< stop a cell after so many seconds (0: no limit; not deterministic)
  uint32_t batch_rays = 1u << 24;  ///< rays of a border or reverse batch at most, 4096 or more; nor has a
                                   ///< batch more than the cell traced before it
  uint64_t validation_rays = 10'000'000;  ///< fresh random rays after each cell that measure the miss rate
  uint64_t seed = 1;
  uint32_t raster_resolution = 1000;  ///< method raster only: pixels along an edge of a hemicube's front side
  double target_error = 0;  ///< stop a cell at this share of wrong pixels (95 % upper bound), in place of the
                            ///< threshold; 0: off, else kSmallestTargetError up to 1
  float smallest_hole = 0;  ///< world units: a ray counts only where it has more room than this
                            ///< (narrow_gap.h) on its way; 0: exact
  float bound = 0;          ///< world units: side of the voxels by which what is hidden was proved, of the
                            ///< bound that limits the sets, or of one itself (method bound); 0: no bound
  bool operator==(const BakeParams&) const = default;
};

inline constexpr double kSmallestTargetError = 1e-10;
inline constexpr uint32_t kFewestBatchRays = 4096;

}  // namespace sightline

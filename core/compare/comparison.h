#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/device/device.h"
#include "core/gvs/bake_cell.h"
#include "core/measure/pixel_error.h"
#include "core/pvs/bake_params.h"
#include "core/pvs/cell_pvs.h"
#include "core/scene/scene.h"

// Methods against each other at equal budgets (thesis 7.1 and 7.2): how large and how wrong their sets are
// after so many rays, or so many seconds.
namespace sightline {

struct CompareOptions {
  std::vector<Method> methods = {Method::kGvspp, Method::kGvs, Method::kRandom};
  BakeParams
      params;  ///< max_rays or max_seconds is the budget; method, seed and validation_rays do not count
  uint64_t seed = 1;     ///< of the first repeat; the others follow
  uint32_t repeats = 3;  ///< 1 .. 1000
  uint32_t points = 6;   ///< at which the pixel error is measured: the whole budget, half of it, ...; 1 .. 40
  uint32_t missing_rays = 1'000'000;  ///< that measure the share of missing rays
  MeasureOptions measure;             ///< its seed decides the views
};

/// A state of a bake, and how wrong it was.
struct ComparePoint {
  double budget_share = 0;   ///< the state is the last within this share of the budget
  CurvePoint state;          ///< all 0 if there was none yet
  double missing_share = 0;  ///< of all rays, as after a bake
  PixelError error;
};

/// One bake of one cell.
struct MethodRun {
  Method method = Method::kGvspp;
  uint64_t seed = 0;
  StopReason stop = StopReason::kConverged;
  std::vector<CurvePoint> curve;       ///< thinned, to the end of the budget
  std::vector<double> missing_shares;  ///< one a point of the curve
  std::vector<ComparePoint> points;    ///< ascending; the last is the whole budget
};

struct CellComparison {
  ViewCell cell;
  std::vector<MethodRun>
      runs;  ///< method after method in the order of the options, within it seed after seed
};

/// Told about the work.
struct CompareEvents {
  /// A bake is running.
  std::function<void(const ViewCell&, Method, uint64_t seed, const BakeProgress&)> bake;
  std::function<void(const ViewCell&, const MeasureProgress&)> measure;
  const std::atomic<bool>* stop = nullptr;  ///< Interrupted is thrown when it becomes true
};

/// Throws Error (wrong usage) that names the option that is out of range. Every method needs a budget.
void checkOptions(const CompareOptions& options);

/// Two bakes of the cell by every method, which do not count: drivers compile shaders and make buffers when
/// they are first needed. The first is short and goes through all stages, whatever the budget. Throws Error,
/// Interrupted.
void warmUp(std::span<Device* const> devices, const Scene& scene, const ViewCell& cell,
            const CompareOptions& options, const CompareEvents& events = {});

/// Bakes the cell by every method with every seed, one after the other, and measures all these sets with the
/// same views and rays. devices: one a method; the first traces the views. What a state is worth is decided
/// by what was in the set, so time spent on measuring does not count. With a budget of rays the result is
/// the same on every run but for the seconds. Throws Error, Interrupted.
CellComparison compareCell(std::span<Device* const> devices, const Scene& scene, const ViewCell& cell,
                           uint32_t cell_index, const CompareOptions& options,
                           const CompareEvents& events = {});

/// The smallest, the middle (the mean of both for an even number) and the largest value.
struct Spread {
  double low = 0, median = 0, high = 0;
};
Spread spreadOf(std::vector<double> values);

/// A method's error over all cells at a point of the budget: for each seed the average over cells, then their
/// spread; as table 7.2 of the thesis has them.
struct MethodSummary {
  Method method = Method::kGvspp;
  Spread average_wrong, mean_max_wrong, average_regions, mean_largest_region;  ///< pixels, regions, of a view
  Spread missing_share, pvs_share, rays, seconds;  ///< shares 0..1, rays of a cell
  uint32_t max_wrong = 0;                          ///< of all views, cells and seeds
};

/// One a method, in the order of the options. point: index into MethodRun::points. cells: not empty.
std::vector<MethodSummary> summarize(std::span<const CellComparison> cells, const CompareOptions& options,
                                     uint32_t triangle_count, size_t point);

}  // namespace sightline

#include "core/compare/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/measure/missing_rays.h"

namespace sightline {
namespace {

/// Points of a curve that are kept.
constexpr size_t kCurvePoints = 60;

/// How much of the budget was spent at a point of the curve, 0 ..
double spentShare(const CurvePoint& point, const BakeParams& params) {
  const double rays = params.max_rays > 0 ? double(point.allRays()) / double(params.max_rays) : 0;
  const double seconds = params.max_seconds > 0 ? point.seconds / params.max_seconds : 0;
  return std::max(rays, seconds);
}

/// The last state within a share of the budget; none: a state of nothing.
CurvePoint stateWithin(const std::vector<CurvePoint>& curve, const BakeParams& params, double share) {
  CurvePoint state;
  for (const CurvePoint& point : curve) {
    if (spentShare(point, params) <= share) state = point;
  }
  return state;
}

/// Points at about equal distances on a logarithmic axis of what is spent, the first and the last included.
std::vector<CurvePoint> thinnedCurve(const std::vector<CurvePoint>& curve, const BakeParams& params) {
  std::vector<CurvePoint> kept;
  double next = 0;
  for (size_t i = 0; i < curve.size(); ++i) {
    const double spent = spentShare(curve[i], params);
    if (spent > 1) break;
    const bool last = i + 1 == curve.size() || spentShare(curve[i + 1], params) > 1;
    if (spent < next && !last) continue;
    kept.push_back(curve[i]);
    next = spent * std::pow(1e3, 1.0 / kCurvePoints);
  }
  return kept;
}

std::vector<uint32_t> sizesOf(const auto& states, auto&& state_of) {
  std::vector<uint32_t> sizes;
  for (const auto& state : states) sizes.push_back(state_of(state).size);
  return sizes;
}

/// A bake with its set in order of discovery.
struct Baked {
  MethodRun run;
  RankedSet set;
};

Baked bakeOnce(Device& device, const Scene& scene, const ViewCell& cell, uint32_t cell_index,
               const CompareOptions& options, Method method, uint64_t seed, const CompareEvents& events) {
  BakeParams params = options.params;
  params.method = method;
  params.seed = seed;
  params.validation_rays = 0;
  BakeTrace trace;
  BakeHooks hooks{{}, events.stop, &trace};
  if (events.bake) {
    hooks.progress = [&](const BakeProgress& progress) { events.bake(cell, method, seed, progress); };
  }
  const CellPvs pvs = bakeCell(device, scene, cell, cell_index, params, hooks);
  Baked baked;
  baked.run.method = method;
  baked.run.seed = seed;
  baked.run.stop = pvs.stats.stop;
  baked.run.curve = thinnedCurve(trace.curve, params);
  for (uint32_t i = options.points; i-- > 0;) {
    const double share = std::exp2(-double(i));
    baked.run.points.push_back({share, stateWithin(trace.curve, params, share), 0, {}});
  }
  baked.set = rankedSet(device.readPvs(), scene.triangleCount(), {});
  return baked;
}

/// The share of missing rays along the curves and at the points, by one pass of rays.
void measureMissing(Device& device, const ViewCell& cell, uint32_t cell_index, const CompareOptions& options,
                    std::vector<Baked>& bakes) {
  std::vector<RankedSet> sets;
  for (Baked& baked : bakes) {
    const auto own = [](const CurvePoint& point) -> const CurvePoint& { return point; };
    std::vector<uint32_t> sizes = sizesOf(baked.run.curve, own);
    for (const ComparePoint& point : baked.run.points) sizes.push_back(point.state.size);
    std::sort(sizes.begin(), sizes.end());
    sets.push_back({std::move(baked.set.rank), std::move(sizes)});
  }
  const auto missing = countMissingRays(device, cell, cell_index, options.seed, options.missing_rays, sets);
  for (size_t b = 0; b < bakes.size(); ++b) {
    const std::vector<uint32_t>& sizes = sets[b].prefixes;
    const auto shareAt = [&](const CurvePoint& state) {
      const auto place = std::lower_bound(sizes.begin(), sizes.end(), state.size) - sizes.begin();
      return double(missing[b][size_t(place)]) / options.missing_rays;
    };
    for (const CurvePoint& state : bakes[b].run.curve) bakes[b].run.missing_shares.push_back(shareAt(state));
    for (ComparePoint& point : bakes[b].run.points) point.missing_share = shareAt(point.state);
    bakes[b].set.rank = std::move(sets[b].rank);
  }
}

void measurePixels(Device& device, const ViewCell& cell, uint32_t cell_index, const CompareOptions& options,
                   std::vector<Baked>& bakes, const CompareEvents& events) {
  std::vector<RankedSet> sets;
  for (Baked& baked : bakes) {
    const auto state = [](const ComparePoint& point) -> const CurvePoint& { return point.state; };
    sets.push_back({std::move(baked.set.rank), sizesOf(baked.run.points, state)});
  }
  const MeasureCallback progress = [&](const MeasureProgress& p) {
    if (events.measure) events.measure(cell, p);
  };
  const std::vector<SetError> errors =
      measureCell(device, cell, cell_index, sets, options.measure, progress, events.stop);
  for (size_t b = 0; b < bakes.size(); ++b) {
    for (size_t p = 0; p < bakes[b].run.points.size(); ++p) {
      bakes[b].run.points[p].error = errors[b].by_prefix[p];
    }
  }
}

}  // namespace

void checkOptions(const CompareOptions& options) {
  const auto require = [](bool good, const char* line) {
    if (!good) throw Error(line, kExitUsage);
  };
  require(!options.methods.empty(), "compare needs a method");
  require(options.params.max_rays > 0 || options.params.max_seconds > 0,
          "compare needs a budget: rays or seconds");
  require(options.repeats >= 1 && options.repeats <= 1000, "repeats must be 1 .. 1000");
  require(options.points >= 1 && options.points <= 40, "points must be 1 .. 40");
  require(options.missing_rays >= 1 && options.missing_rays <= kMostMissingRays,
          "missing-rays must be 1 .. 2^30");
  checkOptions(options.measure);
  checkParams(options.params);
}

void warmUp(std::span<Device* const> devices, const Scene& scene, const ViewCell& cell,
            const CompareOptions& options, const CompareEvents& events) {
  CompareOptions brief = options;
  brief.params.n_rand = brief.params.batch_rays = 1u << 16;
  brief.params.max_rays = 1u << 21;
  brief.params.max_seconds = 0;
  brief.params.order = Order::kQueue;
  brief.points = 1;
  for (size_t m = 0; m < options.methods.size(); ++m) {
    bakeOnce(*devices[m], scene, cell, 0, brief, options.methods[m], options.seed, events);
    bakeOnce(*devices[m], scene, cell, 0, options, options.methods[m], options.seed, events);
  }
}

CellComparison compareCell(std::span<Device* const> devices, const Scene& scene, const ViewCell& cell,
                           uint32_t cell_index, const CompareOptions& options, const CompareEvents& events) {
  std::vector<Baked> bakes;
  for (size_t m = 0; m < options.methods.size(); ++m) {
    for (uint32_t repeat = 0; repeat < options.repeats; ++repeat) {
      bakes.push_back(bakeOnce(*devices[m], scene, cell, cell_index, options, options.methods[m],
                               options.seed + repeat, events));
    }
  }
  measureMissing(*devices[0], cell, cell_index, options, bakes);
  measurePixels(*devices[0], cell, cell_index, options, bakes, events);
  CellComparison comparison{cell, {}};
  for (Baked& baked : bakes) comparison.runs.push_back(std::move(baked.run));
  return comparison;
}

Spread spreadOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
  return {values.front(), median, values.back()};
}

std::vector<MethodSummary> summarize(std::span<const CellComparison> cells, const CompareOptions& options,
                                     uint32_t triangle_count, size_t point) {
  std::vector<MethodSummary> summaries;
  for (size_t m = 0; m < options.methods.size(); ++m) {
    MethodSummary summary;
    summary.method = options.methods[m];
    const auto pointOf = [&](const CellComparison& cell, uint32_t repeat) -> const ComparePoint& {
      return cell.runs[m * options.repeats + repeat].points[point];
    };
    const auto spread = [&](auto&& value) {
      std::vector<double> averages;
      for (uint32_t repeat = 0; repeat < options.repeats; ++repeat) {
        double sum = 0;
        for (const CellComparison& cell : cells) sum += double(value(pointOf(cell, repeat)));
        averages.push_back(sum / double(cells.size()));
      }
      return spreadOf(averages);
    };
    using P = const ComparePoint&;
    summary.average_wrong = spread([](P p) { return p.error.averageWrong(); });
    summary.mean_max_wrong = spread([](P p) { return p.error.max_wrong; });
    summary.average_regions = spread([](P p) { return p.error.averageRegions(); });
    summary.mean_largest_region = spread([](P p) { return p.error.largest_region; });
    summary.missing_share = spread([](P p) { return p.missing_share; });
    summary.pvs_share = spread([&](P p) { return double(p.state.size) / triangle_count; });
    summary.rays = spread([](P p) { return p.state.allRays(); });
    summary.seconds = spread([](P p) { return p.state.seconds; });
    for (const CellComparison& cell : cells) {
      for (uint32_t repeat = 0; repeat < options.repeats; ++repeat) {
        summary.max_wrong = std::max(summary.max_wrong, pointOf(cell, repeat).error.max_wrong);
      }
    }
    summaries.push_back(summary);
  }
  return summaries;
}

}  // namespace sightline

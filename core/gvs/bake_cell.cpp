#include "core/gvs/bake_cell.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/cell/cell_problem.h"
#include "core/gvs/error_bound.h"
#include "core/gvs/exploration_yield.h"
#include "core/gvs/fill_set.h"
#include "core/gvs/rays_in_time.h"
#include "core/gvs/stop_rule.h"
#include "core/gvs/time_left.h"
#include "core/sampling/face_rays.h"
#include "core/sampling/hemicube.h"
#include "core/sampling/make_stage_params.h"
#include "core/sampling/random_segment.h"
#include "core/scene/contained.h"
#include "core/shared/border.h"
#include "core/shared/reverse.h"

namespace sightline {
namespace {

/// Rays of one random launch at most: a second or so on a processor, for progress and interruption; enough to
/// keep a GPU busy. A limit of rays is tested after each, so with one they are the same on every device.
constexpr uint32_t kRandomLaunchRays = 1u << 22, kRandomLaunchRaysGpu = 1u << 24;

/// One cell's bake in progress.
class CellBake {
 public:
  CellBake(Device& device, const Scene& scene, const BakeParams& params, std::vector<Face> faces,
           uint32_t cell_index, const BakeHooks& hooks)
      : device_(device),
        params_(params),
        faces_(std::move(faces)),
        cell_index_(cell_index),
        hooks_(hooks),
        face_rays_(raysByArea(faces_, params.n_rand)),
        stage_params_(
            makeStageParams(params, faces_, haltonShifts(params.seed, cell_index, RandomUse::kSampling))),
        rule_(params),
        time_left_(params, reverseRayCount(stage_params_)),
        random_launch_rays_(device.info().on_cpu || params.max_rays > 0 ? kRandomLaunchRays
                                                                        : kRandomLaunchRaysGpu),
        yield_(params.batch_rays) {
    if (params.method == Method::kRaster) near_distance_ = hemicubeNear(scene, faces_);
    device_.prepare(explores(), stage_params_);
    start_ = Clock::now();
    device_.beginCell(faces_, stage_params_);
    if (hooks_.hidden.empty()) return;
    // In the set from the start, and first in the list: rays that hit them find nothing new.
    device_.insertContained(hooks_.hidden);
    state_.pvs_size = state_.bordered = state_.listed = uint32_t(hooks_.hidden.size());
  }

  /// Everything up to the stop rule: T, or the target of `bound` where there is one. member: a byte a
  /// triangle of the scene, 1 for those that the cell contains.
  void run(ErrorBound* bound, std::vector<uint8_t> member) {
    for (bool more = true; more;) {
      ++state_.stats.iterations;
      state_.iteration_new = 0;
      const double begun = seconds();
      if (sample() && explores()) explore();
      const double now = seconds();
      time_left_.add(state_, now - begun, now);
      more = !rule_.endsAfter(state_.iteration_new);
      if (bound != nullptr && rule_.testDue(state_.rays)) more = !testError(*bound, member);
    }
    state_.stats.stop = rule_.reason();
  }

  /// Adds those of the triangles (ascending) that no ray has found: after run, for what rays find is explored
  /// too.
  void addContained(std::span<const uint32_t> contained) {
    if (contained.empty()) return;
    std::vector<uint32_t> found;
    for (const PvsEntry& entry : device_.readPvs()) found.push_back(entry.origin_triangle.w);
    std::sort(found.begin(), found.end());
    std::vector<uint32_t> unseen;
    std::set_difference(contained.begin(), contained.end(), found.begin(), found.end(),
                        std::back_inserter(unseen));
    device_.insertContained(unseen);
    state_.stats.contained_triangles = unseen.size();
    state_.pvs_size += static_cast<uint32_t>(unseen.size());
    state_.bordered = state_.listed = state_.pvs_size;
  }

  /// Fresh random rays of other shifts; counts those that hit something outside the set.
  void validate() {
    state_.validating = true;
    const uvec4 shifts = haltonShifts(params_.seed, cell_index_, RandomUse::kValidation);
    uint64_t first = 0;
    for (uint64_t left = params_.validation_rays; left > 0;) {
      const auto round = static_cast<uint32_t>(std::min<uint64_t>(left, 1u << 30));
      const std::vector<uint32_t> counts = raysByArea(faces_, round);
      forEachSegment(counts, first, [&](const RandomSegment& segment) {
        state_.stats.missing_rays += device_.countMissing(segment, shifts);
        state_.stats.validation_rays += segment.range.w;
        report(kStageRandom);
        return true;
      });
      first += round;
      left -= round;
    }
  }

  const CellStats& stats() {
    state_.stats.seconds = seconds();
    return state_.stats;
  }

 private:
  using Clock = std::chrono::steady_clock;

  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  /// Whether new triangles are explored.
  bool explores() const { return params_.method != Method::kRandom && params_.method != Method::kRaster; }

  /// One iteration's samples before any exploration. false: a limit was reached.
  bool sample() { return params_.method == Method::kRaster ? sampleHemicubes() : sampleRandom(); }

  /// Whether the bake ends as the error of what has been found is below the target, or by a limit. Adds to
  /// `member` what is new.
  bool testError(ErrorBound& bound, std::vector<uint8_t>& member) {
    for (const PvsEntry& entry : device_.readPvs()) member[entry.origin_triangle.w] = 1;
    state_.testing = true;
    const uint64_t before = bound.rays();
    const bool reached = bound.test(
        [&](std::span<const Ray> rays, std::span<Hit> hits) {
          device_.traceRays(rays, hits);
          // A ray that sees glass outside the set misses, whatever it ends on.
          for (const SeenThrough& seen : device_.traceGlass(rays, hits)) {
            if (member[seen.triangle] == 0) hits[seen.ray].triangle = seen.triangle;
          }
        },
        member,
        [&](uint64_t left) {
          state_.stats.bound_rays = bound.rays();
          state_.test_left = left;
          report(kStageRandom);
          return rule_.afterTestLaunch(seconds());
        },
        rule_.mostTestRays(state_.rays));
    state_.testing = false;
    state_.stats.bound_tests = bound.tests();
    state_.stats.error_bound = bound.bound();
    return rule_.afterTest(reached, state_.rays, bound.rays() - before);
  }

  /// Calls launch for the runs of the sequence that cover counts[f] rays of each face, starting at point
  /// `first`; stops early when it returns false.
  template <typename Launch>
  bool forEachSegment(const std::vector<uint32_t>& counts, uint64_t first, Launch&& launch) {
    uint32_t ray_index = 1;
    for (uint32_t f = 0; f < counts.size(); ++f) {
      for (uint32_t left = counts[f]; left > 0;) {
        const uint32_t count = std::min(left, random_launch_rays_);
        if (!launch(makeRandomSegment(f, first, count, ray_index))) return false;
        first += count;
        ray_index += count;
        left -= count;
      }
    }
    return true;
  }

  /// One iteration's random rays. false: a limit was reached.
  bool sampleRandom() {
    const auto start = Clock::now();
    const bool more = forEachSegment(face_rays_, next_point_, [&](const RandomSegment& segment) {
      device_.traceRandom(segment);
      state_.random_left = params_.n_rand - (segment.batch.x - 1 + segment.range.w);
      return finishLaunch(kStageRandom, state_.stats.random);
    });
    next_point_ += params_.n_rand;
    close(kStageRandom, state_.stats.random, start);
    if (!explores()) state_.bordered = state_.pvs_size;
    return more;
  }

  /// As many hemicubes as have about as many samples as an iteration has random rays, one at least.
  bool sampleHemicubes() {
    const auto start = Clock::now();
    const uint32_t samples = hemicubeSamples(params_.raster_resolution);
    const uint32_t hemicubes = std::max(1u, params_.n_rand / samples);
    bool more = true;
    for (uint32_t i = 0; i < hemicubes && more; ++i) {
      const Hemicube hemicube = placeHemicube(faces_, next_point_++, stage_params_.shifts);
      device_.drawer().rasterize(hemicube, params_.raster_resolution, near_distance_);
      state_.random_left = (hemicubes - 1 - i) * samples;
      more = finishLaunch(kStageRandom, state_.stats.random);
    }
    close(kStageRandom, state_.stats.random, start);
    state_.bordered = state_.pvs_size;
    return more;
  }

  /// Border and reverse rays of what is new. false: a limit was reached.
  bool explore() {
    const bool queue = params_.order == Order::kQueue || params_.method == Method::kGvs;
    return queue ? exploreQueue() : exploreByYield();
  }

  /// As the thesis does: reverse rays of a batch of triangles follow its border rays, until no unexplored
  /// triangle is left.
  bool exploreQueue() {
    while (state_.bordered < state_.pvs_size) {
      if (!border()) return false;
      while (state_.waiting() > 0) {
        if (!reverse()) return false;
      }
    }
    return true;
  }

  /// Goes on with what promises the most triangles a ray, border or reverse rays, as long as that is more
  /// than the random rays of this iteration found; the rest waits for a later one. But border rays may always
  /// catch up with random rays, for a batch is no fair sample of all that wait, and an iteration that has
  /// found fewer than T triangles leaves nothing.
  bool exploreByYield() {
    const double random_yield = double(state_.iteration_new) / params_.n_rand;
    while (state_.bordered < state_.pvs_size || state_.waiting() > 0 || state_.listed < state_.bordered) {
      const uint32_t entries = state_.pvs_size - state_.bordered;
      const bool catching_up = entries > 0 && state_.stats.border.rays < state_.stats.random.rays;
      const double border_yield = entries > 0 ? yield_.border(entries) : -1;
      const double reverse_yield =
          state_.waiting() > 0 || state_.listed < state_.bordered ? yield_.reverse() : -1;
      const bool may_wait = state_.iteration_new >= params_.threshold && !catching_up;
      if (may_wait && std::max(border_yield, reverse_yield) < random_yield) return true;
      const bool to_border = entries > 0 && (catching_up || border_yield >= reverse_yield);
      if (!(to_border ? border() : state_.waiting() > 0 ? reverse() : listAgain())) return false;
    }
    return true;
  }

  /// Rays of the next border or reverse batch at most: no more than all before it, so that such a batch runs
  /// past a limit by less than the limit; with a limit of time, on a processor, what is likely to end in
  /// time.
  uint32_t batchRays() const {
    const uint64_t most = std::clamp<uint64_t>(state_.rays, kFewestBatchRays, params_.batch_rays);
    if (params_.max_seconds == 0 || !device_.info().on_cpu) return static_cast<uint32_t>(most);
    return raysInTime(state_.stats, params_.max_seconds - seconds(), most);
  }

  /// A batch of border rays. Once the list of discontinuities is full, those of this and all later entries
  /// wait for listAgain. false: a limit was reached.
  bool border() {
    const bool reverses = reverseRayCount(stage_params_) > 0;
    const bool in_step =
        state_.listed == state_.bordered && (!reverses || state_.discontinuities < hooks_.most_listed);
    const uint32_t found = state_.pvs_size;
    const uint64_t rays = state_.rays;
    const uint32_t entries = borderBatch(state_.bordered, in_step && reverses);
    yield_.bookBorder(entries, state_.rays - rays, state_.pvs_size - found);
    if (in_step) state_.listed = state_.bordered;
    return rule_.unlimited();
  }

  /// Border rays once more, of entries whose discontinuities found no room in the list, which is empty now.
  /// false: a limit was reached.
  bool listAgain() {
    state_.listed += borderBatch(state_.listed, true);
    return rule_.unlimited();
  }

  /// Traces and books a batch of border rays of the entries from `first`; returns the number of its entries.
  uint32_t borderBatch(uint32_t first, bool listing) {
    const auto start = Clock::now();
    const BorderBatch batch = device_.traceBorder(first, batchRays(), listing);
    state_.bordered = std::max(state_.bordered, first + batch.entries);
    state_.discontinuities += batch.discontinuities;
    state_.discontinuities_total += batch.discontinuities;
    finishLaunch(kStageBorder, state_.stats.border);
    close(kStageBorder, state_.stats.border, start);
    return batch.entries;
  }

  /// A batch of reverse rays of those that wait. false: a limit was reached.
  bool reverse() {
    const auto start = Clock::now();
    const uint32_t items_per_batch = std::max(1u, batchRays() / reverseRayCount(stage_params_));
    const uint32_t count = std::min(items_per_batch, state_.waiting());
    device_.traceReverse(state_.reversed, count);
    state_.reversed += count;
    const uint64_t rays = state_.rays;
    const uint32_t found = state_.pvs_size;
    const bool more = finishLaunch(kStageReverse, state_.stats.reverse);
    close(kStageReverse, state_.stats.reverse, start);
    yield_.bookReverse(state_.rays - rays, state_.pvs_size - found);
    if (state_.waiting() == 0) {
      device_.dropDiscontinuities();
      state_.discontinuities = state_.reversed = 0;
    }
    return more;
  }

  /// Books the rays of a launch. false: a limit was reached.
  bool finishLaunch(uint32_t stage, StageStats& stats) {
    const DeviceCounters counters = device_.counters();
    stats.rays += counters.rays - state_.rays;
    state_.rays = counters.rays;
    state_.stats.peak_device_bytes = std::max(state_.stats.peak_device_bytes, counters.memory_bytes);
    report(stage);
    return rule_.afterLaunch(state_.rays, seconds());
  }

  /// Ends a batch: its new triangles join the list.
  void close(uint32_t stage, StageStats& stats, Clock::time_point start) {
    const uint32_t found = device_.collect(stage);
    stats.new_triangles += found;
    state_.pvs_size += found;
    state_.iteration_new += found;
    stats.seconds += std::chrono::duration<double>(Clock::now() - start).count();
    if (hooks_.trace != nullptr) hooks_.trace->curve.push_back(curvePoint());
  }

  CurvePoint curvePoint() const {
    const CellStats& s = state_.stats;
    return {seconds(),
            {s.random.rays, s.border.rays, s.reverse.rays},
            {s.random.new_triangles, s.border.new_triangles, s.reverse.new_triangles},
            state_.pvs_size,
            s.iterations};
  }

  void report(uint32_t stage) {
    if (hooks_.stop != nullptr && *hooks_.stop) throw Interrupted{};
    if (!hooks_.progress) return;
    BakeProgress p;
    p.iteration = state_.stats.iterations;
    p.stage = stage;
    p.testing = state_.testing;
    p.validating = state_.validating;
    p.rays = state_.rays + state_.stats.validation_rays + state_.stats.bound_rays;
    p.pvs_size = state_.pvs_size - uint32_t(hooks_.hidden.size());
    p.new_triangles = state_.iteration_new;
    p.queued = state_.pvs_size - state_.bordered;
    p.seconds = seconds();
    // Before the first border rays nobody knows how much there is to explore.
    const bool known = !explores() || state_.stats.border.rays > 0 || state_.stats.iterations > 1 ||
                       state_.validating || state_.testing;
    if (known) {
      time_left_.estimate(state_, p);
    } else {
      p.seconds_left = -1;
    }
    hooks_.progress(p);
  }

  Device& device_;
  const BakeParams& params_;
  std::vector<Face> faces_;
  uint32_t cell_index_;
  const BakeHooks& hooks_;
  std::vector<uint32_t> face_rays_;  ///< random rays of an iteration, by face
  StageParams stage_params_;
  CellState state_;
  StopRule rule_;
  TimeLeft time_left_;
  Clock::time_point start_;
  uint32_t random_launch_rays_;
  uint64_t next_point_ = 0;  ///< of the Halton sequence; never restarts
  float near_distance_ = 0;  ///< of hemicubes
  ExplorationYield yield_;
};

}  // namespace

CellPvs bakeCell(Device& device, const Scene& scene, const ViewCell& cell, uint32_t cell_index,
                 const BakeParams& params, const BakeHooks& hooks) {
  checkParams(params);
  if (const auto problem = cellProblem(cell)) {
    throw Error(fmt::format("cell {}, {}: {}", cell_index, cell.name, problem->text()), kExitUsage);
  }
  requireDrawable(params.method, scene);
  if (params.method == Method::kNaive && !device.info().naive) {
    throw Error(
        device.info().id + ": the method naive takes a device of makeNaiveDevice; on this one it is gvs++",
        kExitUsage);
  }
  if (hooks.trace != nullptr) *hooks.trace = {};
  CellPvs pvs;
  pvs.cell = cell;
  CellBake bake(device, scene, params, cellFaces(cell), cell_index, hooks);
  const std::vector<uint32_t> contained = containedTriangles(scene, cell);
  if (params.target_error > 0) {
    ErrorBound bound(cell, cell_index, params.seed, params.target_error);
    std::vector<uint8_t> member(scene.triangleCount(), 0);
    for (const uint32_t triangle : contained) member[triangle] = 1;
    bake.run(&bound, std::move(member));
  } else {
    bake.run(nullptr, {});
  }
  bake.addContained(contained);
  bake.validate();
  const std::vector<PvsEntry> all = device.readPvs();
  const std::span<const PvsEntry> entries = std::span(all).subspan(hooks.hidden.size());
  if (hooks.trace != nullptr) {
    for (const PvsEntry& entry : entries) hooks.trace->order.push_back(entry.origin_triangle.w);
  }
  fillSet(entries, pvs);
  pvs.stats = bake.stats();
  return pvs;
}

}  // namespace sightline

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
#include "core/gvs/finish_watch.h"
#include "core/gvs/iteration_forecast.h"
#include "core/gvs/rays_in_time.h"
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

/// After a test of the error, so many times its rays are traced before the next one: tests take a fifth of
/// all rays at most. Those that fail soon, while the error is large, hold up nothing.
constexpr uint64_t kRaysBetweenTests = 4;

/// Where the time left is given as a range: the probability that the bake ends before it, and after it.
constexpr double kEarlyChance = 0.1;

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
        random_launch_rays_(device.info().on_cpu || params.max_rays > 0 ? kRandomLaunchRays
                                                                        : kRandomLaunchRaysGpu),
        yield_(params.batch_rays) {
    stage_params_ =
        makeStageParams(params, faces_, haltonShifts(params.seed, cell_index, RandomUse::kSampling));
    if (params.method == Method::kRaster) near_distance_ = hemicubeNear(scene, faces_);
    device_.beginCell(faces_, stage_params_);
  }

  /// Everything up to the stop rule: T, or the target of `bound` where there is one. member: a byte a
  /// triangle of the scene, 1 for those that the cell contains.
  void run(ErrorBound* bound, std::vector<uint8_t> member) {
    uint32_t quiet = 0;
    for (bool more = true; more;) {
      ++stats_.iterations;
      iteration_new_ = 0;
      const double begun = seconds();
      more = sample() && (!explores() || explore());
      quiet = iteration_new_ < params_.threshold ? quiet + 1 : 0;
      forecast_.add(iteration_new_, seconds() - begun);
      finish_.add(seconds(), convergence(double(rays_) / seconds()));
      if (bound != nullptr) {
        const bool reached = (rays_ >= next_test_ || !more) && testError(*bound, member);
        if (reached) stats_.stop = StopReason::kTargetError;
        more = stats_.stop == StopReason::kConverged;
      } else if (quiet >= params_.quiet_iterations) {
        more = false;
      }
    }
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
    stats_.contained_triangles = unseen.size();
    pvs_size_ += static_cast<uint32_t>(unseen.size());
    bordered_ = listed_ = pvs_size_;
  }

  /// Fresh random rays of other shifts; counts those that hit something outside the set.
  void validate() {
    validating_ = true;
    const uvec4 shifts = haltonShifts(params_.seed, cell_index_, RandomUse::kValidation);
    uint64_t first = 0;
    for (uint64_t left = params_.validation_rays; left > 0;) {
      const auto round = static_cast<uint32_t>(std::min<uint64_t>(left, 1u << 30));
      const std::vector<uint32_t> counts = raysByArea(faces_, round);
      forEachSegment(counts, first, [&](const RandomSegment& segment) {
        stats_.missing_rays += device_.countMissing(segment, shifts);
        stats_.validation_rays += segment.range.w;
        report(kStageRandom);
        return true;
      });
      first += round;
      left -= round;
    }
  }

  const CellStats& stats() {
    stats_.seconds = seconds();
    return stats_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  bool timeIsUp() const { return params_.max_seconds > 0 && seconds() >= params_.max_seconds; }

  /// Whether new triangles are explored.
  bool explores() const { return params_.method != Method::kRandom && params_.method != Method::kRaster; }

  /// One iteration's samples before any exploration. false: a limit was reached.
  bool sample() { return params_.method == Method::kRaster ? sampleHemicubes() : sampleRandom(); }

  /// Whether the error of what has been found is below the target. Adds to `member` what is new. After a
  /// limit the test is brief, to say where the error stands; before, the limits end it.
  bool testError(ErrorBound& bound, std::vector<uint8_t>& member) {
    for (const PvsEntry& entry : device_.readPvs()) member[entry.origin_triangle.w] = 1;
    const bool limited = stats_.stop != StopReason::kConverged;
    uint64_t most = rays_ / kRaysBetweenTests + 1;
    if (!limited) most = params_.max_rays == 0 ? ~uint64_t(0) : std::max(most, params_.max_rays - rays_);
    testing_ = true;
    const uint64_t before = bound.rays();
    const bool reached = bound.test(
        [&](std::span<const Ray> rays, std::span<Hit> hits) { device_.traceRays(rays, hits); }, member,
        [&](uint64_t left) {
          stats_.bound_rays = bound.rays();
          test_left_ = left;
          report(kStageRandom);
          if (!limited && timeIsUp()) stats_.stop = StopReason::kTimeLimit;
          return limited || stats_.stop == StopReason::kConverged;
        },
        most);
    testing_ = false;
    next_test_ = rays_ + kRaysBetweenTests * (bound.rays() - before);
    stats_.bound_tests = bound.tests();
    stats_.error_bound = bound.bound();
    return reached;
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
      random_left_ = params_.n_rand - (segment.batch.x - 1 + segment.range.w);
      return finishLaunch(kStageRandom, stats_.random);
    });
    next_point_ += params_.n_rand;
    close(kStageRandom, stats_.random, start);
    if (!explores()) bordered_ = pvs_size_;
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
      random_left_ = (hemicubes - 1 - i) * samples;
      more = finishLaunch(kStageRandom, stats_.random);
    }
    close(kStageRandom, stats_.random, start);
    bordered_ = pvs_size_;
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
    while (bordered_ < pvs_size_) {
      if (!border()) return false;
      while (waiting() > 0) {
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
    const double random_yield = double(iteration_new_) / params_.n_rand;
    while (bordered_ < pvs_size_ || waiting() > 0 || listed_ < bordered_) {
      const uint32_t entries = pvs_size_ - bordered_;
      const bool catching_up = entries > 0 && stats_.border.rays < stats_.random.rays;
      const double border_yield = entries > 0 ? yield_.border(entries) : -1;
      const double reverse_yield = waiting() > 0 || listed_ < bordered_ ? yield_.reverse() : -1;
      const bool may_wait = iteration_new_ >= params_.threshold && !catching_up;
      if (may_wait && std::max(border_yield, reverse_yield) < random_yield) return true;
      const bool to_border = entries > 0 && (catching_up || border_yield >= reverse_yield);
      if (!(to_border ? border() : waiting() > 0 ? reverse() : listAgain())) return false;
    }
    return true;
  }

  /// Rays of the next border or reverse batch at most: no more than all before it, so that such a batch runs
  /// past a limit by less than the limit; with a limit of time, on a processor, what is likely to end in
  /// time.
  uint32_t batchRays() const {
    const uint64_t most = std::clamp<uint64_t>(rays_, kFewestBatchRays, params_.batch_rays);
    if (params_.max_seconds == 0 || !device_.info().on_cpu) return static_cast<uint32_t>(most);
    return raysInTime(stats_, params_.max_seconds - seconds(), most);
  }

  /// Discontinuities whose reverse rays are still to be traced.
  uint32_t waiting() const { return discontinuities_ - reversed_; }

  /// A batch of border rays. Once the list of discontinuities is full, those of this and all later entries
  /// wait for listAgain. false: a limit was reached.
  bool border() {
    const bool reverses = reverseRayCount(stage_params_) > 0;
    const bool in_step = listed_ == bordered_ && (!reverses || discontinuities_ < hooks_.most_listed);
    const uint32_t found = pvs_size_;
    const uint64_t rays = rays_;
    const uint32_t entries = borderBatch(bordered_, in_step && reverses);
    yield_.bookBorder(entries, rays_ - rays, pvs_size_ - found);
    if (in_step) listed_ = bordered_;
    return stats_.stop == StopReason::kConverged;
  }

  /// Border rays once more, of entries whose discontinuities found no room in the list, which is empty now.
  /// false: a limit was reached.
  bool listAgain() {
    listed_ += borderBatch(listed_, true);
    return stats_.stop == StopReason::kConverged;
  }

  /// Traces and books a batch of border rays of the entries from `first`; returns the number of its entries.
  uint32_t borderBatch(uint32_t first, bool listing) {
    const auto start = Clock::now();
    const BorderBatch batch = device_.traceBorder(first, batchRays(), listing);
    bordered_ = std::max(bordered_, first + batch.entries);
    discontinuities_ += batch.discontinuities;
    discontinuities_total_ += batch.discontinuities;
    finishLaunch(kStageBorder, stats_.border);
    close(kStageBorder, stats_.border, start);
    return batch.entries;
  }

  /// A batch of reverse rays of those that wait. false: a limit was reached.
  bool reverse() {
    const auto start = Clock::now();
    const uint32_t items_per_batch = std::max(1u, batchRays() / reverseRayCount(stage_params_));
    const uint32_t count = std::min(items_per_batch, waiting());
    device_.traceReverse(reversed_, count);
    reversed_ += count;
    const uint64_t rays = rays_;
    const uint32_t found = pvs_size_;
    const bool more = finishLaunch(kStageReverse, stats_.reverse);
    close(kStageReverse, stats_.reverse, start);
    yield_.bookReverse(rays_ - rays, pvs_size_ - found);
    if (waiting() == 0) {
      device_.dropDiscontinuities();
      discontinuities_ = reversed_ = 0;
    }
    return more;
  }

  /// Books the rays of a launch. false: a limit was reached.
  bool finishLaunch(uint32_t stage, StageStats& stats) {
    const DeviceCounters counters = device_.counters();
    stats.rays += counters.rays - rays_;
    rays_ = counters.rays;
    stats_.peak_device_bytes = std::max(stats_.peak_device_bytes, counters.memory_bytes);
    report(stage);
    if (params_.max_rays > 0 && rays_ >= params_.max_rays) stats_.stop = StopReason::kRayLimit;
    if (timeIsUp()) stats_.stop = StopReason::kTimeLimit;
    return stats_.stop == StopReason::kConverged;
  }

  /// Ends a batch: its new triangles join the list.
  void close(uint32_t stage, StageStats& stats, Clock::time_point start) {
    const uint32_t found = device_.collect(stage);
    stats.new_triangles += found;
    pvs_size_ += found;
    iteration_new_ += found;
    stats.seconds += std::chrono::duration<double>(Clock::now() - start).count();
    if (hooks_.trace != nullptr) hooks_.trace->curve.push_back(curvePoint());
  }

  CurvePoint curvePoint() const {
    const CellStats& s = stats_;
    return {seconds(),
            {s.random.rays, s.border.rays, s.reverse.rays},
            {s.random.new_triangles, s.border.new_triangles, s.reverse.new_triangles},
            pvs_size_,
            s.iterations};
  }

  void report(uint32_t stage) {
    if (hooks_.stop != nullptr && *hooks_.stop) throw Interrupted{};
    if (!hooks_.progress) return;
    BakeProgress p;
    p.iteration = stats_.iterations;
    p.stage = stage;
    p.testing = testing_;
    p.validating = validating_;
    p.rays = rays_ + stats_.validation_rays + stats_.bound_rays;
    p.pvs_size = pvs_size_;
    p.new_triangles = iteration_new_;
    p.queued = pvs_size_ - bordered_;
    p.seconds = seconds();
    // Before the first border rays nobody knows how much there is to explore.
    const bool known =
        !explores() || stats_.border.rays > 0 || stats_.iterations > 1 || validating_ || testing_;
    if (known) {
      setTimeLeft(p);
    } else {
      p.seconds_left = -1;
    }
    hooks_.progress(p);
  }

  /// Estimates the seconds until the cell is done: to its limits, or less where T may end it. Negative:
  /// nobody knows.
  void setTimeLeft(BakeProgress& p) const {
    const double rays_a_second = double(p.rays) / p.seconds;
    if (validating_) {
      p.seconds_left = double(params_.validation_rays - stats_.validation_rays) / rays_a_second;
      return;
    }
    const bool limited = params_.max_seconds > 0 || params_.max_rays > 0;
    const bool endless = params_.threshold == 0 || params_.target_error > 0;
    double left = limited ? 1e18 : -1;
    if (params_.max_seconds > 0) left = params_.max_seconds - p.seconds;
    if (params_.max_rays > 0) {
      left = std::min(left, (double(params_.max_rays) - double(rays_)) / rays_a_second);
    }
    if (limited) left = std::max(left, 0.0) + double(params_.validation_rays) / rays_a_second;
    p.seconds_left = left;
    if (endless && !testing_) return;
    const double estimate = testing_ ? testRaysDue() / rays_a_second : convergence(rays_a_second);
    if (limited && left <= estimate) return;
    p.seconds_left = estimate;
    if (testing_) return;
    p.at_least = !forecast_.foretells(params_.threshold);
    if (p.at_least || !finish_.standsStill()) return;
    p.seconds_left_from = convergence(rays_a_second, kEarlyChance);
    p.seconds_left_to = convergence(rays_a_second, 1 - kEarlyChance);
    if (limited) p.seconds_left_to = std::min(p.seconds_left_to, left);
  }

  /// Rays until the cell is done, if it passes the test of the error that it is in.
  double testRaysDue() const { return double(test_left_ + params_.validation_rays); }

  /// Estimate of the seconds until T ends the cell, if the queue grows no further: in so many that it has
  /// with probability `chance`.
  double convergence(double rays_a_second, double chance = 0.5) const {
    const double reverse_each = double(reverseRayCount(stage_params_));
    const double explored = std::max(1.0, double(bordered_));
    const double border_each = double(stats_.border.rays) / explored;
    const double waiting_each = double(discontinuities_total_) / explored;
    const double entries = double(pvs_size_ - listed_);
    const double rays = double(waiting()) * reverse_each +
                        entries * (border_each + waiting_each * reverse_each) +
                        double(params_.validation_rays);
    const double iterations = iterationsDue(chance) + double(random_left_) / params_.n_rand;
    const double each = stats_.iterations > 1 ? forecast_.secondsEach(params_.threshold)
                                              : double(params_.n_rand) / rays_a_second;
    return iterations * each + rays / rays_a_second;
  }

  /// Estimate of the iterations after this one.
  double iterationsDue(double chance) const {
    const double next = iteration_new_ >= params_.threshold ? 1 : 0;
    return std::max(next, forecast_.due(params_.threshold, chance) - 1) + params_.quiet_iterations - 1;
  }

  Device& device_;
  const BakeParams& params_;
  std::vector<Face> faces_;
  uint32_t cell_index_;
  const BakeHooks& hooks_;
  std::vector<uint32_t> face_rays_;  ///< random rays of an iteration, by face
  StageParams stage_params_{};
  CellStats stats_;
  Clock::time_point start_ = Clock::now();
  uint32_t random_launch_rays_;
  uint64_t next_point_ = 0;  ///< of the Halton sequence; never restarts
  float near_distance_ = 0;  ///< of hemicubes
  uint64_t rays_ = 0;
  uint32_t random_left_ = 0;  ///< random rays of this iteration still to trace
  uint32_t pvs_size_ = 0;
  uint32_t bordered_ = 0;  ///< entries of the list whose border rays have been traced
  uint32_t listed_ = 0;    ///< entries whose discontinuities have been listed; fewer once the list was full
  uint32_t discontinuities_ = 0;        ///< that the device has listed ...
  uint32_t reversed_ = 0;               ///< ... and whose reverse rays have been traced
  uint64_t discontinuities_total_ = 0;  ///< of the cell
  ExplorationYield yield_;
  uint32_t iteration_new_ = 0;
  IterationForecast forecast_;  ///< of the iterations before this one
  FinishWatch finish_;          ///< of convergence() after each iteration
  uint64_t next_test_ = 0;      ///< rays traced when the error is next tested against the target
  uint64_t test_left_ = 0;      ///< rays of the test in work
  bool testing_ = false, validating_ = false;
};

}  // namespace

CellPvs bakeCell(Device& device, const Scene& scene, const ViewCell& cell, uint32_t cell_index,
                 const BakeParams& params, const BakeHooks& hooks) {
  checkParams(params);
  if (const auto problem = cellProblem(cell)) {
    throw Error(fmt::format("cell {}, {}: {}", cell_index, cell.name, problem->text()), kExitUsage);
  }
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
    std::vector<uint8_t> member(scene.triangles.size(), 0);
    for (const uint32_t triangle : contained) member[triangle] = 1;
    bake.run(&bound, std::move(member));
  } else {
    bake.run(nullptr, {});
  }
  bake.addContained(contained);
  bake.validate();
  const std::vector<PvsEntry> entries = device.readPvs();
  if (hooks.trace != nullptr) {
    for (const PvsEntry& entry : entries) hooks.trace->order.push_back(entry.origin_triangle.w);
  }
  fillSet(entries, pvs);
  pvs.stats = bake.stats();
  return pvs;
}

}  // namespace sightline

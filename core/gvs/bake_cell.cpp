#include "core/gvs/bake_cell.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <numeric>

#include "core/error.h"
#include "core/gvs/error_bound.h"
#include "core/gvs/face_rays.h"
#include "core/gvs/hemicube.h"
#include "core/gvs/random_segment.h"
#include "core/scene/contained.h"
#include "core/shared/border.h"
#include "core/shared/reverse.h"

namespace sightline {
namespace {

/// Rays of one random launch at most: a second or so on a slow device, for progress and interruption.
constexpr uint32_t kRandomLaunchRays = 1u << 22;

/// After a test of the error, so many times its rays are traced before the next one: tests take a fifth of
/// all rays at most. Those that fail soon, while the error is large, hold up nothing.
constexpr uint64_t kRaysBetweenTests = 4;

/// No border batch yet.
constexpr uint32_t kNoBatch = 0xffffffffu;

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
        face_rays_(raysByArea(faces_, params.n_rand)) {
    stage_params_.counts = uvec4(params.n_abs_edge, params.n_rs_edge, params.n_rs_area, faces_.size());
    stage_params_.shifts = haltonShifts(params.seed, cell_index, RandomUse::kSampling);
    stage_params_.distances =
        vec4(params.delta_abs_relative, params.delta_abs, params.delta_rs_relative, params.delta_rs);
    stage_params_.method.x = params.method == Method::kGvs ? kSampleGvs : kSampleGvspp;
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
      more = sample() && (!explores() || explore());
      quiet = iteration_new_ < params_.threshold ? quiet + 1 : 0;
      if (bound != nullptr) {
        // After a limit, too, but briefly: to say where the error stands.
        const uint64_t most = more ? ~uint64_t(0) : rays_ / kRaysBetweenTests + 1;
        const bool reached = (rays_ >= next_test_ || !more) && testError(*bound, member, most);
        if (reached && more) stats_.stop = StopReason::kTargetError;
        more = more && !reached;
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
    explored_ = bordered_ = pvs_size_;
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

  /// Whether new triangles are explored, or random rays are all there is.
  bool explores() const { return params_.method != Method::kRandom && params_.method != Method::kRaster; }

  /// One iteration's samples before any exploration. false: a limit was reached.
  bool sample() { return params_.method == Method::kRaster ? sampleHemicubes() : sampleRandom(); }

  /// Whether the error of what has been found is below the target. Adds to `member` what is new.
  bool testError(ErrorBound& bound, std::vector<uint8_t>& member, uint64_t most) {
    for (const PvsEntry& entry : device_.readPvs()) member[entry.origin_triangle.w] = 1;
    validating_ = true;
    const uint64_t before = bound.rays();
    const bool reached = bound.test(
        [&](std::span<const Ray> rays, std::span<Hit> hits) { device_.traceRays(rays, hits); }, member,
        [&](uint64_t rays) {
          stats_.bound_rays = rays;
          report(kStageRandom);
        },
        most);
    validating_ = false;
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
        const uint32_t count = std::min(left, kRandomLaunchRays);
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
    if (!explores()) explored_ = bordered_ = pvs_size_;
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
      device_.rasterize(hemicube, params_.raster_resolution, near_distance_);
      random_left_ = (hemicubes - 1 - i) * samples;
      more = finishLaunch(kStageRandom, stats_.random);
    }
    close(kStageRandom, stats_.random, start);
    explored_ = bordered_ = pvs_size_;
    return more;
  }

  /// Border and reverse rays until no unexplored triangle is left. false: a limit was reached.
  ///
  /// A border ray finds twenty to fifty times as many triangles as a reverse ray (docs/evaluation.md), so
  /// those of all triangles go first: a bake that a limit ends has found most by then. For the reverse rays
  /// of a batch its border rays are traced once more, unless they were the last. Of gvs, reverse rays are
  /// few, and go along.
  bool explore() {
    while (explored_ < pvs_size_) {
      if (params_.method != Method::kGvs) {
        while (bordered_ < pvs_size_) {
          if (!border(bordered_)) return false;
        }
      }
      if (batch_first_ != explored_ && !border(explored_)) return false;
      in_work_ = batch_count_;
      if (!reverse(batch_discontinuities_)) return false;
      explored_ += batch_count_;
      in_work_ = 0;
    }
    return true;
  }

  /// Border rays of the entries from `first`, as many as a batch holds; remembers the batch. false: a limit
  /// was reached.
  bool border(uint32_t first) {
    const auto start = Clock::now();
    const uint32_t entries_per_batch = std::max(1u, params_.batch_rays / borderRayCount(stage_params_));
    batch_first_ = first;
    batch_count_ = std::min(entries_per_batch, pvs_size_ - first);
    batch_discontinuities_ = device_.traceBorder(first, batch_count_);
    const bool more = finishLaunch(kStageBorder, stats_.border);
    close(kStageBorder, stats_.border, start);
    bordered_ = std::max(bordered_, first + batch_count_);
    return more;
  }

  bool reverse(uint32_t discontinuities) {
    const uint32_t per_item = reverseRayCount(stage_params_);
    if (per_item == 0) return true;
    reverse_left_ = uint64_t(discontinuities) * per_item;
    const uint32_t items_per_batch = std::max(1u, params_.batch_rays / per_item);
    for (uint32_t item = 0; item < discontinuities;) {
      const auto start = Clock::now();
      const uint32_t count = std::min(items_per_batch, discontinuities - item);
      device_.traceReverse(item, count);
      reverse_left_ -= uint64_t(count) * per_item;
      const bool more = finishLaunch(kStageReverse, stats_.reverse);
      close(kStageReverse, stats_.reverse, start);
      if (!more) return false;
      item += count;
    }
    return true;
  }

  /// Books the rays of a launch. false: a limit was reached.
  bool finishLaunch(uint32_t stage, StageStats& stats) {
    const DeviceCounters counters = device_.counters();
    stats.rays += counters.rays - rays_;
    rays_ = counters.rays;
    stats_.peak_device_bytes = std::max(stats_.peak_device_bytes, counters.memory_bytes);
    report(stage);
    if (params_.max_rays > 0 && rays_ >= params_.max_rays) stats_.stop = StopReason::kRayLimit;
    if (params_.max_seconds > 0 && seconds() >= params_.max_seconds) stats_.stop = StopReason::kTimeLimit;
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
    p.validating = validating_;
    p.rays = rays_ + stats_.validation_rays + stats_.bound_rays;
    p.pvs_size = pvs_size_;
    p.new_triangles = iteration_new_;
    p.queued = pvs_size_ - explored_;
    p.seconds = seconds();
    // Before the first border rays nobody knows how much there is to explore.
    const bool known = !explores() || stats_.border.rays > 0 || stats_.iterations > 1 || validating_;
    p.seconds_left = known ? raysDue() * p.seconds / double(p.rays) : -1;
    hooks_.progress(p);
  }

  /// Estimate of the rays until the cell is done, if the queue grows no further and this iteration is the
  /// last.
  double raysDue() const {
    const uint32_t taken_up = explored_ + in_work_;
    const double border_each = double(borderRayCount(stage_params_));
    const double reverse_each = taken_up == 0 ? 0 : double(stats_.reverse.rays + reverse_left_) / taken_up;
    return double(random_left_) + double(reverse_left_) + double(pvs_size_ - bordered_) * border_each +
           double(pvs_size_ - taken_up) * (border_each + reverse_each) +
           double(params_.validation_rays - stats_.validation_rays);
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
  uint64_t next_point_ = 0;  ///< of the Halton sequence; never restarts
  float near_distance_ = 0;  ///< of hemicubes
  uint64_t rays_ = 0;
  uint32_t random_left_ = 0;  ///< random rays of this iteration still to trace
  uint32_t pvs_size_ = 0;
  uint32_t explored_ = 0;  ///< entries of the list that need no more exploration
  uint32_t in_work_ = 0;   ///< entries after them whose reverse rays are being traced
  uint32_t bordered_ = 0;  ///< entries whose border rays have been traced
  uint32_t batch_first_ = kNoBatch, batch_count_ = 0;  ///< entries of the last border batch ...
  uint32_t batch_discontinuities_ = 0;                 ///< ... and how many discontinuities it met
  uint64_t reverse_left_ = 0;                          ///< reverse rays of these still to trace
  uint32_t iteration_new_ = 0;
  uint64_t next_test_ = 0;  ///< rays traced when the error is next tested against the target
  bool validating_ = false;
};

/// Sorts the list by triangle into set and witnesses.
void fillSet(const std::vector<PvsEntry>& entries, CellPvs& pvs) {
  std::vector<uint32_t> order(entries.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return entries[a].origin_triangle.w < entries[b].origin_triangle.w;
  });
  const auto point = [](uvec4 bits) {
    return vec3(uintBitsToFloat(bits.x), uintBitsToFloat(bits.y), uintBitsToFloat(bits.z));
  };
  pvs.triangles.reserve(order.size());
  pvs.witnesses.reserve(order.size());
  for (const uint32_t i : order) {
    pvs.triangles.push_back(entries[i].origin_triangle.w);
    pvs.witnesses.push_back(
        {point(entries[i].origin_triangle), point(entries[i].direction_stage), entries[i].direction_stage.w});
  }
}

}  // namespace

void checkParams(const BakeParams& p) {
  const auto require = [](bool good, const char* line) {
    if (!good) throw Error(line, kExitUsage);
  };
  require(p.method <= Method::kNaive, "no such method");
  require(p.raster_resolution >= 16 && p.raster_resolution <= kMaxViewResolution,
          "raster-resolution must be 16 .. 16384");
  require(p.target_error == 0 || (p.target_error >= kSmallestTargetError && p.target_error < 1),
          "target-error must be 0 (off) or 1e-10 .. 1");
  require(p.n_rand >= 1 && p.n_rand <= 0xfffffffdu, "n-rand must be 1 .. 4294967293");
  require(p.n_abs_edge <= 1000, "n-abs-edge must be 0 .. 1000");
  require(p.n_rs_edge <= 1000, "n-rs-edge must be 0 .. 1000");
  require(p.n_rs_area <= 100'000, "n-rs-area must be 0 .. 100000");
  require(p.batch_rays >= 4096 && p.batch_rays <= 1u << 28, "batch-rays must be 4096 .. 268435456");
  require(p.quiet_iterations >= 1, "quiet-iterations must be at least 1");
  require(p.threshold >= 1 || p.max_rays > 0 || p.max_seconds > 0 || p.target_error > 0,
          "threshold 0 never ends: give max-rays, max-seconds or target-error too");
  const auto distance = [](float x) { return std::isfinite(x) && x >= 0; };
  require(distance(p.delta_abs) && distance(p.delta_abs_relative) && p.delta_abs + p.delta_abs_relative > 0,
          "delta-abs and delta-abs-relative must be finite, not negative, and one of them above 0");
  require(distance(p.delta_rs) && distance(p.delta_rs_relative),
          "delta-rs and delta-rs-relative must be finite and not negative");
  require(std::isfinite(p.max_seconds) && p.max_seconds >= 0, "max-seconds must be finite and not negative");
}

void requireMethodOn(Method method, const std::string& device) {
  if (method != Method::kRaster || device.starts_with("vulkan")) return;
  throw Error("the method raster draws by Vulkan: use --device vulkan, not " + device, kExitUsage);
}

CellPvs bakeCell(Device& device, const Scene& scene, const ViewCell& cell, uint32_t cell_index,
                 const BakeParams& params, const BakeHooks& hooks) {
  checkParams(params);
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

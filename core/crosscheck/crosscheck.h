#pragma once
#include <array>
#include <atomic>
#include <functional>
#include <span>
#include <vector>

#include "core/crosscheck/difference.h"
#include "core/crosscheck/error_histogram.h"
#include "core/crosscheck/ray_answers.h"
#include "core/crosscheck/ray_kinds.h"

namespace sightline {

struct CrosscheckOptions {
  uint64_t rays = 100'000;     ///< of each kind, over all cells
  std::vector<RayKind> kinds;  ///< empty: all
  uint64_t seed = 1;
  uint64_t check_every =
      100;  ///< of rays on which all devices agree, the judge looks at 1 in so many; 0: none
  RoundingLimit rounding;
  uint32_t keep_disagreements = 0;  ///< in full, at most
  uint32_t batch_rays = 1u << 17;   ///< bounds the memory
};

/// What one device answered to the rays of one kind.
struct DeviceTally {
  uint64_t hits = 0;
  uint64_t glass = 0;                                ///< triangles of glass that rays see, of all rays
  std::array<uint64_t, kDifferences> differences{};  ///< from the first device's answers
  std::array<uint64_t, kVerdicts> disputed{};        ///< verdicts on rays on which devices differ
  std::array<uint64_t, kVerdicts> checked{};         ///< verdicts on other rays that the judge looked at
  double steps_beside = 0;                           ///< of a rounded answer: the most (see Ruling)
  ErrorHistogram ulps;  ///< of t against that of the triangle's plane, in units in the last place of float

  uint64_t verdicts(Verdict verdict) const { return disputed[size_t(verdict)] + checked[size_t(verdict)]; }
};

struct KindReport {
  RayKind kind = RayKind::kRandom;
  uint64_t rays = 0;      ///< that have a direction
  uint64_t disputed = 0;  ///< two devices differ in the triangle, or in the glass before it
  uint64_t checked =
      0;  ///< all agree, yet the judge looked: samples, and aimed rays that went past their target
  std::vector<DeviceTally> devices;
};

/// A ray of a cross-check in full.
struct CheckedRay {
  uint32_t cell = 0;
  RayKind kind = RayKind::kRandom;
  uint64_t number = 0;
  RayAnswers answers;
};

struct WorstRay {
  CheckedRay checked;
  uint32_t device = 0;  ///< whose answer it is here for
  double measure = 0;   ///< steps beside, or error of t in ulps where the answer is right
};

/// Rays on which devices name different triangles, or on which an answer is missed or wrong.
struct Disagreements {
  uint64_t count = 0;
  uint64_t illegal = 0;          ///< of them: an answer is missed or wrong
  std::vector<CheckedRay> rays;  ///< illegal ones first, as they came; no more than were asked for
};

struct CrosscheckReport {
  std::vector<DeviceInfo> devices;
  bool glass = false;  ///< the scene has some: answers are what ends a ray, and what it sees before that
  std::vector<KindReport> kinds;
  std::vector<WorstRay> worst;  ///< ten at most a device: wrong, missed, rounded, then large errors of t
  Disagreements disagreements;
  double trace_seconds = 0, judge_seconds = 0;
  /// By device: triangles of its sets that the cells' definition rules out, if sets were compared
  /// (comparePvs). Wrong as a wrong answer is.
  std::vector<uint64_t> wrong_in_sets;
};

/// Told after every thousand rays or so: kind, rays done and due over all.
using CrosscheckProgress = std::function<void(RayKind kind, uint64_t done, uint64_t due)>;

/// Traces the same rays on all devices, which hold `scene`; the judge decides where they differ. Cells share
/// the rays, whose targets a bake on `baker` finds. Deterministic but for the seconds. Stops early when *stop
/// becomes true. Throws Error.
CrosscheckReport crosscheck(const Scene& scene, const Bvh& bvh, std::span<const ViewCell> cells,
                            std::span<Tracer* const> devices, Device& baker, const CrosscheckOptions& options,
                            const CrosscheckProgress& progress = {}, const std::atomic<bool>* stop = nullptr);

}  // namespace sightline

#include "core/crosscheck/crosscheck.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>
#include <tuple>

#include "core/base/interrupted.h"
#include "core/gvs/bake_cell.h"
#include "core/shared/ray.h"
#include "core/trace/sights.h"

namespace sightline {
namespace {

/// Rays judged between two looks at the stop flag: the judge may take milliseconds for one where coordinates
/// have so few bits that everything touches everything.
constexpr size_t kSliceRays = 1024;
/// Rays shown in full, for each device.
constexpr size_t kWorstRays = 10;
/// An aimed ray's answer beyond this t is looked at: its target lies at t = 1, up to rounding.
constexpr float kSuspiciousDistance = 1 + 0x1p-12f;

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// What the judge says of one answer.
struct Opinion {
  Difference difference = Difference::kSame;
  Ruling ruling;
  double ulps = -1;  ///< error of t; < 0: none
};

/// The state of one ray of a batch.
struct JudgedRay {
  bool disputed = false, judged = false;
  ExactHit exact;
};

/// Units in the last place of float by which t errs from the distance of its triangle's plane.
double ulpsOff(const Judge& judge, const Ray& ray, const Hit& hit) {
  if (hit.triangle >= judge.triangleCount()) return -1;
  const auto plane = judge.planeDistance(judgeRay(ray), hit.triangle);
  if (!plane || !(plane->low > 0)) return -1;
  const double exact = plane->low + (plane->high - plane->low) / 2;
  const int exponent = std::max(std::ilogb(exact), -126);
  return std::fabs(double(hit.t) - exact) / std::ldexp(1.0, exponent - 23);
}

/// Keeps the worst answers of one device.
class WorstRays {
 public:
  void consider(const WorstRay& ray) {
    const auto worse = [](const WorstRay& a, const WorstRay& b) { return rank(a) > rank(b); };
    const auto place = std::upper_bound(rays_.begin(), rays_.end(), ray, worse);
    if (place == rays_.end() && rays_.size() == kWorstRays) return;
    rays_.insert(place, ray);
    if (rays_.size() > kWorstRays) rays_.pop_back();
  }
  bool wouldTake(Verdict verdict, double measure) const {
    return rays_.size() < kWorstRays || std::tuple(verdict, measure) > rank(rays_.back());
  }
  const std::vector<WorstRay>& rays() const { return rays_; }

 private:
  static std::tuple<Verdict, double> rank(const WorstRay& ray) {
    return {ray.checked.answers.rulings[ray.device].verdict, ray.measure};
  }
  std::vector<WorstRay> rays_;  ///< worst first; the earlier of equals
};

/// Keeps the first disagreements, of those that are legal and of those that are not.
class DisagreementList {
 public:
  explicit DisagreementList(size_t most) : most_(most) {}

  /// makeRay(): the ray in full, if it is to be kept.
  template <typename MakeRay>
  void add(bool legal, MakeRay&& makeRay) {
    ++(legal ? legal_count_ : illegal_count_);
    std::vector<CheckedRay>& rays = legal ? legal_ : illegal_;
    if (rays.size() < most_) rays.push_back(makeRay());
  }
  Disagreements finish() {
    Disagreements all{legal_count_ + illegal_count_, illegal_count_, std::move(illegal_)};
    const size_t room = std::min(most_ - all.rays.size(), legal_.size());
    all.rays.insert(all.rays.end(), legal_.begin(), legal_.begin() + ptrdiff_t(room));
    return all;
  }

 private:
  size_t most_;
  uint64_t legal_count_ = 0, illegal_count_ = 0;
  std::vector<CheckedRay> legal_, illegal_;
};

class Crosscheck {
 public:
  Crosscheck(const Scene& scene, const Bvh& bvh, std::span<Tracer* const> devices,
             const CrosscheckOptions& options)
      : judge_(scene, bvh),
        devices_(devices),
        options_(options),
        worst_(devices.size()),
        disagreements_(options.keep_disagreements) {
    for (const Tracer* device : devices) report_.devices.push_back(device->info());
    report_.glass = judge_.hasGlass();
    std::vector<RayKind> kinds = options.kinds;
    for (uint32_t k = 0; options.kinds.empty() && k < kRayKinds; ++k) kinds.push_back(RayKind(k));
    for (const RayKind kind : kinds) {
      report_.kinds.push_back({kind, 0, 0, 0, std::vector<DeviceTally>(devices.size())});
    }
  }

  size_t kinds() const { return report_.kinds.size(); }
  RayKind kind(size_t index) const { return report_.kinds[index].kind; }

  /// Traces rays first .. first + count - 1 of a kind from a cell, and judges them; `judged` is called with
  /// the number of each slice of them, and may throw.
  void batch(const RayMaker& maker, uint32_t cell, size_t kind_index, uint64_t first, size_t count,
             const std::function<void(size_t)>& judged) {
    rays_.resize(count);
    maker.make(kind(kind_index), first, rays_);
    const auto start = std::chrono::steady_clock::now();
    sights_.resize(devices_.size());
    for (size_t d = 0; d < devices_.size(); ++d) sights_[d].trace(*devices_[d], rays_);
    report_.trace_seconds += secondsSince(start);

    judged_.assign(count, {});
    opinions_.assign(count * devices_.size(), {});
    for (size_t begin = 0, end = 0; begin < count; begin = end) {
      const auto judge_start = std::chrono::steady_clock::now();
      end = std::min(begin + kSliceRays, count);
      tbb::parallel_for(begin, end, [&](size_t i) { form(i, kind(kind_index), first); });
      for (size_t i = begin; i < end; ++i) book(i, cell, kind_index, first);
      report_.judge_seconds += secondsSince(judge_start);
      judged(end - begin);
    }
  }

  CrosscheckReport finish() {
    for (const WorstRays& rays : worst_) {
      report_.worst.insert(report_.worst.end(), rays.rays().begin(), rays.rays().end());
    }
    report_.disagreements = disagreements_.finish();
    return std::move(report_);
  }

 private:
  const Hit& hit(size_t ray, size_t device) const { return sights_[device].hits()[ray]; }

  bool seesGlassAsFirst(size_t ray, size_t device) const {
    return std::ranges::equal(sights_[device].glass(ray), sights_[0].glass(ray));
  }

  Opinion& opinion(size_t ray, size_t device) { return opinions_[ray * devices_.size() + device]; }

  /// Forms the opinions on ray i.
  void form(size_t i, RayKind kind, uint64_t first) {
    const Ray& ray = rays_[i];
    if (!hasDirection(ray)) return;
    JudgedRay& judged = judged_[i];
    const Hit& reference = hit(i, 0);
    judged.judged = options_.check_every > 0 && (first + i) % options_.check_every == 0;
    for (size_t d = 0; d < devices_.size(); ++d) {
      const Hit& its = hit(i, d);
      if (its.triangle != reference.triangle || !seesGlassAsFirst(i, d))
        judged.disputed = judged.judged = true;
      const bool past = its.triangle == kNoTriangle || !(its.t <= kSuspiciousDistance);
      if (isAimed(kind) && past) judged.judged = true;
      if (its.triangle != kNoTriangle) opinion(i, d).ulps = ulpsOff(judge_, ray, its);
    }
    if (!judged.judged) return;
    judged.exact = judge_.nearest(judgeRay(ray));
    for (size_t d = 0; d < devices_.size(); ++d) {
      Opinion& its = opinion(i, d);
      its.difference = differenceOf(judge_, ray, reference, hit(i, d), options_.rounding);
      if (its.difference == Difference::kSame && !seesGlassAsFirst(i, d)) its.difference = Difference::kGlass;
      its.ruling = ruleSight(judge_, ray, hit(i, d), sights_[d].glassIds(i), judged.exact, options_.rounding);
    }
  }

  /// Adds ray i to the report.
  void book(size_t i, uint32_t cell, size_t kind_index, uint64_t first) {
    if (!hasDirection(rays_[i])) return;
    KindReport& kind_report = report_.kinds[kind_index];
    const JudgedRay& judged = judged_[i];
    ++kind_report.rays;
    kind_report.disputed += judged.disputed;
    kind_report.checked += judged.judged && !judged.disputed;
    for (size_t d = 0; d < devices_.size(); ++d) {
      DeviceTally& tally = kind_report.devices[d];
      const Opinion& its = opinion(i, d);
      tally.hits += hit(i, d).triangle != kNoTriangle;
      tally.glass += sights_[d].glass(i).size();
      ++tally.differences[size_t(its.difference)];
      if (its.ulps >= 0) tally.ulps.add(its.ulps);
      if (judged.judged) {
        ++(judged.disputed ? tally.disputed : tally.checked)[size_t(its.ruling.verdict)];
        if (its.ruling.verdict == Verdict::kRounded) {
          tally.steps_beside = std::max(tally.steps_beside, its.ruling.steps_beside);
        }
      }
      considerWorst(i, d, cell, kind(kind_index), first);
    }
    if (!judged.judged) return;
    const auto full = [&] { return inFull(i, cell, kind(kind_index), first); };
    bool legal = true;
    for (size_t d = 0; d < devices_.size(); ++d) {
      const Verdict verdict = opinion(i, d).ruling.verdict;
      legal = legal && verdict != Verdict::kMissed && verdict != Verdict::kWrong;
    }
    if (judged.disputed || !legal) disagreements_.add(legal, full);
  }

  CheckedRay inFull(size_t i, uint32_t cell, RayKind kind, uint64_t first) {
    CheckedRay ray{cell, kind, first + i, {}};
    ray.answers.ray = rays_[i];
    ray.answers.exact = judged_[i].judged ? judged_[i].exact : judge_.nearest(judgeRay(rays_[i]));
    ray.answers.exact_glass = judge_.glassBefore(judgeRay(rays_[i]), ray.answers.exact);
    for (size_t d = 0; d < devices_.size(); ++d) {
      ray.answers.hits.push_back(hit(i, d));
      ray.answers.glass.push_back(sights_[d].glassIds(i));
      ray.answers.rulings.push_back(opinion(i, d).ruling);
    }
    return ray;
  }

  void considerWorst(size_t i, size_t d, uint32_t cell, RayKind kind, uint64_t first) {
    const Opinion& its = opinion(i, d);
    const bool right = its.ruling.verdict == Verdict::kRight;
    const double measure = right ? its.ulps : its.ruling.steps_beside;
    if (!worst_[d].wouldTake(its.ruling.verdict, measure)) return;
    worst_[d].consider({inFull(i, cell, kind, first), uint32_t(d), measure});
  }

  Judge judge_;
  std::span<Tracer* const> devices_;
  const CrosscheckOptions& options_;
  CrosscheckReport report_;
  std::vector<WorstRays> worst_;  ///< by device
  DisagreementList disagreements_;
  std::vector<Ray> rays_;
  std::vector<Sights> sights_;  ///< by device
  std::vector<JudgedRay> judged_;
  std::vector<Opinion> opinions_;  ///< by ray, then device
};

}  // namespace

CrosscheckReport crosscheck(const Scene& scene, const Bvh& bvh, std::span<const ViewCell> cells,
                            std::span<Tracer* const> devices, Device& baker, const CrosscheckOptions& options,
                            const CrosscheckProgress& progress, const std::atomic<bool>* stop) {
  Crosscheck check(scene, bvh, devices, options);
  const uint64_t due = options.rays * check.kinds();
  uint64_t done = 0;
  const auto report = [&](RayKind kind) {
    if (progress) progress(kind, done, due);
    if (stop != nullptr && *stop) throw Interrupted{};
  };
  try {
    for (uint32_t c = 0; c < cells.size(); ++c) {
      const uint64_t begin = options.rays * c / cells.size(), end = options.rays * (c + 1) / cells.size();
      if (begin == end) continue;
      report(check.kind(0));
      const RayMaker maker(scene, cells[c], c, baker, options.seed, end - begin, stop);
      for (size_t k = 0; k < check.kinds(); ++k) {
        for (uint64_t first = 0; first < end - begin; first += options.batch_rays) {
          const auto count = size_t(std::min<uint64_t>(options.batch_rays, end - begin - first));
          check.batch(maker, c, k, first, count, [&](size_t judged) {
            done += judged;
            report(check.kind(k));
          });
        }
      }
    }
  } catch (const Interrupted&) {
    // The report holds what was judged by then.
  }
  return check.finish();
}

}  // namespace sightline

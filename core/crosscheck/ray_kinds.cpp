#include "core/crosscheck/ray_kinds.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/crosscheck/adversarial_rays.h"
#include "core/gvs/bake_cell.h"
#include "core/sampling/make_stage_params.h"
#include "core/sampling/ray_random.h"
#include "core/sampling/stage_rays.h"
#include "core/shared/random_ray.h"

namespace sightline {
namespace {

constexpr const char* kNames[] = {"random",     "border", "reverse", "vertex", "edge",
                                  "along-edge", "axis",   "grazing", "plane",  "far-tiny"};
static_assert(std::size(kNames) == kRayKinds);

/// Random rays of the bake that looks for targets, and all its rays at most.
constexpr uint32_t kSearchRandomRays = 300'000;
constexpr uint64_t kSearchRays = 10'000'000;
/// Border rays that are traced for discontinuities at most; each gives up to 100 reverse rays.
constexpr uint64_t kMostBorderRays = 1u << 18;
/// Keys of the streams of random numbers that are not a ray kind's.
constexpr uint64_t kShiftsKey = 100, kDiscontinuityKey = 101;

BakeParams searchParams(uint64_t seed) {
  BakeParams params;
  params.n_rand = kSearchRandomRays;
  params.max_rays = kSearchRays;
  params.validation_rays = 0;
  params.seed = seed;
  return params;
}

StageParams stageParams(const BakeParams& params, std::span<const Face> faces, uint64_t key) {
  RayRandom random(key, kShiftsKey);
  const uint32_t base2 = uint32_t(random.bits() >> 32), base3 = random.pick(kHaltonPeriod3);
  const uint32_t base5 = random.pick(kHaltonPeriod5), base7 = random.pick(kHaltonPeriod7);
  return makeStageParams(params, faces, uvec4(base2, base3, base5, base7));
}

/// Whether all numbers are finite: from a scene as large as floats go, rays may run out of them.
bool isFinite(const Ray& ray) {
  const vec3 o = xyz3(ray.origin), d = xyz3(ray.direction);
  return std::isfinite(maxAbs3(o)) && std::isfinite(maxAbs3(d)) && o == o && d == d;
}

/// A border ray of any entry.
Ray anyBorderRay(const Scene& scene, std::span<const PvsEntry> entries, const StageParams& params,
                 RayRandom& random) {
  if (entries.empty()) return noRay();
  const PvsEntry& entry = entries[random.pick(entries.size())];
  const uint32_t samples = borderSamplesOf(scene, entry, params);
  return borderRayOf(scene, entry, random.pick(borderRayCount(samples, params)), samples, params);
}

}  // namespace

std::string rayKindName(RayKind kind) {
  return kNames[size_t(kind)];
}

std::optional<RayKind> rayKindOf(const std::string& name) {
  const auto found = std::find(std::begin(kNames), std::end(kNames), name);
  if (found == std::end(kNames)) return std::nullopt;
  return RayKind(found - std::begin(kNames));
}

bool isAimed(RayKind kind) {
  return kind == RayKind::kVertex || kind == RayKind::kEdge || kind == RayKind::kAxis ||
         kind == RayKind::kGrazing || kind == RayKind::kFarTiny;
}

RayMaker::RayMaker(const Scene& scene, const ViewCell& cell, uint32_t cell_index, Device& device,
                   uint64_t seed, uint64_t rays, const std::atomic<bool>* stop)
    : scene_(scene), faces_(cellFaces(cell)), key_(splitmix(splitmix(seed) ^ cell_index)) {
  const Bounds bounds = sceneBounds(scene);
  const vec3 extent = bounds.high - bounds.low, half = glm::abs(vec3(faces_[0].corner) - bounds.low);
  reach_ = std::max(maxAbs3(extent), maxAbs3(half));
  const BakeParams params = searchParams(seed);
  params_ = stageParams(params, faces_, key_);
  bakeCell(device, scene, cell, cell_index, params, {.stop = stop});
  entries_ = device.readPvs();
  std::erase_if(entries_, [](const PvsEntry& entry) { return entry.direction_stage.w == kStageContained; });
  findDiscontinuities(device, rays);
}

void RayMaker::findDiscontinuities(Device& device, uint64_t rays) {
  std::vector<Ray> border(std::min(rays, kMostBorderRays));
  tbb::parallel_for(size_t(0), border.size(), [&](size_t i) {
    RayRandom random(key_ ^ kDiscontinuityKey, i);
    border[i] = anyBorderRay(scene_, entries_, params_, random);
  });
  std::vector<Hit> hits(border.size());
  device.traceRays(border, hits);
  const HostStage stage{&scene_, faces_, &params_};
  for (size_t i = 0; i < border.size(); ++i) {
    if (!hasDirection(border[i]) || !isDiscontinuity(border[i], hits[i], params_)) continue;
    const uint32_t occluder = hits[i].triangle;
    discontinuities_.push_back(reverseItemPast(stage, border[i], occluder, discontinuities_.size()));
  }
}

void RayMaker::make(RayKind kind, uint64_t first, std::span<Ray> rays) const {
  tbb::parallel_for(size_t(0), rays.size(), [&](size_t i) {
    rays[i] = ray(kind, first + i);
    if (!isFinite(rays[i])) rays[i] = noRay();
  });
}

Ray RayMaker::ray(RayKind kind, uint64_t number) const {
  RayRandom random(key_ ^ uint64_t(kind), number);
  switch (kind) {
    case RayKind::kRandom:
      return randomRay(number / faces_.size(), 0, faces_[number % faces_.size()], params_.shifts);
    case RayKind::kBorder:
      return anyBorderRay(scene_, entries_, params_, random);
    case RayKind::kReverse: {
      if (discontinuities_.empty()) return noRay();
      const ReverseItem& item = discontinuities_[random.pick(discontinuities_.size())];
      return reverseRayOf(HostStage{&scene_, faces_, &params_}, item, random.pick(reverseRayCount(params_)));
    }
    default:
      return adversarialRay(kind, AdversarialScene{scene_, faces_, entries_, reach_}, random);
  }
}

}  // namespace sightline

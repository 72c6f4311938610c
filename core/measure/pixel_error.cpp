#include "core/measure/pixel_error.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <numeric>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/gvs/bake_cell.h"
#include "core/measure/classifier.h"

namespace sightline {
namespace {

/// Pixels of the first launch, and how long one should take: progress and Ctrl-C, on slow devices too.
constexpr uint64_t kFirstPixels = 1u << 18;
constexpr double kLaunchSeconds = 0.25;
/// Pixels of a launch where there is glass: their rays travel.
constexpr uint64_t kGlassPixels = 1u << 20;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Traces all views, a launch at a time; the images of one launch are classified while the device traces the
/// next.
void traceAndClassify(Tracer& tracer, std::span<const ViewFrame> frames, uint32_t resolution,
                      Classifier& classifier, const MeasureCallback& progress,
                      const std::atomic<bool>* stop) {
  const auto start = Clock::now();
  const size_t pixels = size_t(resolution) * resolution, most = viewsALaunch(resolution);
  size_t launch_views = std::clamp<size_t>(kFirstPixels / pixels, 1, most);
  std::array<std::vector<uint32_t>, 2> images;
  tbb::task_group classification;
  try {
    for (size_t done = 0, turn = 0; done < frames.size(); turn ^= 1) {
      if (stop && *stop) throw Interrupted{};
      const auto launch_start = Clock::now();
      const size_t count = std::min(launch_views, frames.size() - done);
      images[turn].resize(count * pixels);
      tracer.traceViews(frames.subspan(done, count), resolution, images[turn]);
      if (secondsSince(launch_start) < kLaunchSeconds) launch_views = std::min(most, 2 * launch_views);
      classification.wait();
      classification.run(
          [&classifier, &image = images[turn], done] { classifier.classify(uint32_t(done), image); });
      done += count;
      if (progress) {
        progress({uint32_t(done), uint32_t(frames.size()), done * pixels, secondsSince(start)});
      }
    }
  } catch (...) {
    classification.wait();
    throw;
  }
  classification.wait();
}

/// The same where there is glass: a pixel shows all that its ray sees, and is wrong where a set lacks any of
/// it.
void traceAndClassifyGlass(Tracer& tracer, std::span<const ViewFrame> frames, std::span<const RankedSet> sets,
                           uint32_t resolution, Classifier& classifier, const MeasureCallback& progress,
                           const std::atomic<bool>* stop) {
  const auto start = Clock::now();
  const size_t pixels = size_t(resolution) * resolution, most = std::max<size_t>(1, kGlassPixels / pixels);
  std::vector<std::vector<uint16_t>> levels;
  for (const RankedSet& set : sets) levels.push_back(missingLevels(set));
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::vector<uint32_t> image;
  for (size_t done = 0; done < frames.size();) {
    if (stop && *stop) throw Interrupted{};
    const size_t count = std::min(most, frames.size() - done);
    rays.resize(count * pixels);
    hits.resize(rays.size());
    tbb::parallel_for(size_t(0), rays.size(), [&](size_t i) {
      const auto pixel = uint32_t(i % pixels);
      rays[i] = viewRay(frames[done + i / pixels], pixel % resolution, pixel / resolution, resolution);
    });
    tracer.traceRays(rays, hits);
    const std::vector<SeenThrough> glass = tracer.traceGlass(rays, hits);
    image.resize(rays.size());
    for (size_t s = 0; s < sets.size(); ++s) {
      for (size_t i = 0; i < image.size(); ++i) image[i] = hits[i].triangle;
      for (const SeenThrough& seen : glass) {
        uint32_t& shown = image[seen.ray];
        if (shown == kNoTriangle || levels[s][seen.triangle] > levels[s][shown]) shown = seen.triangle;
      }
      classifier.classify(uint32_t(done), image, s);
    }
    done += count;
    if (progress) progress({uint32_t(done), uint32_t(frames.size()), done * pixels, secondsSince(start)});
  }
}

SetError summarizeSet(const Classifier& classifier, size_t set, size_t prefixes,
                      const MeasureOptions& options) {
  SetError result;
  result.by_prefix.resize(prefixes);
  std::vector<uint32_t> views;
  for (uint32_t view = 0; view < options.views; ++view) {
    const std::span<const ImageError> errors = classifier.errors(set, view);
    if (errors.back().wrong > 0) views.push_back(view);
    for (size_t k = 0; k < prefixes; ++k) {
      PixelError& sum = result.by_prefix[k];
      const ImageError& image = errors[k];
      ++sum.views;
      sum.pixels += uint64_t(options.resolution) * options.resolution;
      sum.wrong += image.wrong;
      sum.regions += image.regions;
      if (image.wrong > sum.max_wrong) sum.worst_view = view;
      sum.max_wrong = std::max(sum.max_wrong, image.wrong);
      sum.max_regions = std::max(sum.max_regions, image.regions);
      sum.largest_region = std::max(sum.largest_region, image.largest_region);
    }
  }
  const auto wrong = [&](uint32_t view) { return classifier.errors(set, view).back().wrong; };
  std::stable_sort(views.begin(), views.end(), [&](uint32_t a, uint32_t b) { return wrong(a) > wrong(b); });
  views.resize(std::min<size_t>(views.size(), options.worst_views));
  result.worst_views = std::move(views);
  return result;
}

}  // namespace

void checkOptions(const MeasureOptions& options) {
  const auto require = [](bool good, const std::string& line) {
    if (!good) throw Error(line, kExitUsage);
  };
  require(options.views >= 1 && options.views <= kMaxMeasureViews,
          fmt::format("views must be 1 .. {}", kMaxMeasureViews));
  require(options.resolution >= 1 && options.resolution <= kMaxMeasureResolution,
          fmt::format("resolution must be 1 .. {}", kMaxMeasureResolution));
  require(options.fov >= kSmallestFov && options.fov <= kLargestFov,
          fmt::format("fov must be {} .. {} degrees", kSmallestFov, kLargestFov));
}

std::vector<SetError> measureCell(Tracer& tracer, const ViewCell& cell, uint32_t cell_index,
                                  std::span<const RankedSet> sets, const MeasureOptions& options,
                                  const MeasureCallback& progress, const std::atomic<bool>* stop) {
  checkOptions(options);
  std::vector<SetError> errors;
  if (sets.empty()) return errors;
  Classifier classifier(sets, options.views, options.resolution);
  const std::vector<ViewFrame> frames =
      measureViews(cell, cell_index, options.views, options.seed, options.fov);
  if (tracer.hasGlass()) {
    traceAndClassifyGlass(tracer, frames, sets, options.resolution, classifier, progress, stop);
  } else {
    traceAndClassify(tracer, frames, options.resolution, classifier, progress, stop);
  }
  for (size_t s = 0; s < sets.size(); ++s) {
    errors.push_back(summarizeSet(classifier, s, sets[s].prefixes.size(), options));
  }
  return errors;
}

SceneError summarize(std::span<const PixelError> cells) {
  SceneError scene;
  for (const PixelError& cell : cells) {
    scene.average_wrong += cell.averageWrong();
    scene.average_regions += cell.averageRegions();
    scene.wrong_share += cell.wrongShare();
    scene.mean_max_wrong += cell.max_wrong;
    scene.mean_largest_region += cell.largest_region;
    scene.max_wrong = std::max(scene.max_wrong, cell.max_wrong);
    scene.largest_region = std::max(scene.largest_region, cell.largest_region);
  }
  if (cells.empty()) return scene;
  for (double* mean : {&scene.average_wrong, &scene.average_regions, &scene.wrong_share,
                       &scene.mean_max_wrong, &scene.mean_largest_region}) {
    *mean /= double(cells.size());
  }
  return scene;
}

}  // namespace sightline

#include "core/walk/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/measure/error_regions.h"
#include "core/walk/alpha_cover.h"
#include "core/walk/pop_watch.h"
#include "core/walk/traced_frame.h"

namespace sightline {
namespace {

double medianOf(std::vector<double>& values) {
  std::ranges::sort(values);
  const size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

/// Of each number, over the same frame of several replays.
FrameTimes medianTimes(std::span<const std::vector<FrameTimes>> replays, size_t frame) {
  std::vector<double> values;
  const auto median = [&](auto&& number) {
    values.clear();
    for (const auto& replay : replays) values.push_back(number(replay[frame]));
    return medianOf(values);
  };
  FrameTimes times;
  times.frame = median([](const FrameTimes& t) { return t.frame; });
  times.gpu_frame = median([](const FrameTimes& t) { return t.gpu_frame; });
  for (size_t i = 0; i < times.cpu.size(); ++i)
    times.cpu[i] = median([&](const FrameTimes& t) { return t.cpu[i]; });
  for (size_t i = 0; i < times.gpu.size(); ++i)
    times.gpu[i] = median([&](const FrameTimes& t) { return t.gpu[i]; });
  return times;
}

/// Pixels of the largest group of false ones that touch. wrong: ascending.
uint32_t largestRegion(const uvec2& size, std::span<const size_t> wrong) {
  if (wrong.empty()) return 0;
  std::vector<PixelRun> runs;
  for (const size_t pixel : wrong) {
    const auto at = uint32_t(pixel);
    if (!runs.empty() && runs.back().last + 1 == at && at % size.x != 0) {
      runs.back().last = at;
    } else {
      runs.push_back({at, at, 1});
    }
  }
  ImageError error;
  ErrorRegions(size.x, size.y).count(runs, {&error, 1});
  return error.largest_region;
}

/// A method while it is replayed.
struct Running {
  std::unique_ptr<WalkPlayer> player;
  std::vector<std::vector<FrameTimes>> replays;  ///< whole ones
  std::vector<FrameTimes> broken;                ///< the one that was ended
  std::vector<FrameTimes> warm_up;               ///< the first, as far as it came
};

class Replayer {
 public:
  Replayer(WalkDevice& device, const WalkScene& scene, const WalkFrames& frames, const ReplayOptions& options,
           Tracer* tracer, const WalkClock& clock, const ReplayHooks& hooks)
      : device_(device),
        scene_(scene),
        frames_(frames),
        options_(options),
        tracer_(tracer),
        clock_(clock),
        hooks_(hooks),
        cover_(scene.scene, scene.draw.drawables) {}

  WalkReplay run(const std::vector<std::string>& methods) {
    const double start = clock_();
    result_.alpha = cover_.any();
    for (const std::string& name : methods) {
      result_.methods.push_back({.name = name});
      running_.push_back({device_.play(name, options_.method), {}, {}, {}});
    }
    all_ = uint64_t(methods.size()) * frames_.cameras.size() * (options_.repeats + 2);
    try {
      for (uint32_t repeat = 0; repeat <= options_.repeats; ++repeat) {
        for (size_t i = 0; i < methods.size(); ++i) time((i + repeat) % methods.size(), repeat);
      }
      for (size_t i = 0; i < methods.size(); ++i) check(i);
    } catch (const Interrupted&) {
      result_.complete = false;
    } catch (const Error& error) {
      result_.complete = false;
      result_.problem = error.what();
      result_.problem_code = error.exitCode();
    }
    for (size_t i = 0; i < methods.size(); ++i) keepTimes(i);
    result_.seconds = (clock_() - start) / 1000;
    return std::move(result_);
  }

 private:
  void step(const std::string& method, const char* pass, uint32_t frame) {
    if (hooks_.stop != nullptr && *hooks_.stop) throw Interrupted{};
    if (hooks_.progress) {
      hooks_.progress({method, pass, frame, uint32_t(frames_.cameras.size()), done_, all_});
    }
    ++done_;
  }

  /// One whole replay; repeat 0 is dropped.
  void time(size_t method, uint32_t repeat) {
    Running& running = running_[method];
    MethodReplay& found = result_.methods[method];
    const std::string pass =
        repeat == 0 ? "warm-up" : fmt::format("repeat {} of {}", repeat, options_.repeats);
    running.player->forget();
    running.broken.clear();
    const bool counts_here = !walkMethod(found.name).on_gpu;  // else they cost a wait
    std::vector<FrameTimes>& times = repeat == 0 ? running.warm_up : running.broken;
    std::vector<FrameCounts> counts;
    const auto keepCounts = [&] {
      if (counts_here && counts.size() >= found.counts.size()) found.counts = counts;
    };
    try {
      for (uint32_t frame = 0; frame < frames_.cameras.size(); ++frame) {
        step(found.name, pass.c_str(), frame);
        FrameTimes now;
        const double start = clock_();
        running.player->draw(frames_.cameras[frame], frame, options_.in_flight, now);
        now.frame = clock_() - start;
        times.push_back(now);
        if (counts_here) counts.push_back(running.player->counts());
        if (frame + 1 >= options_.in_flight) {
          const uint32_t done = frame + 1 - options_.in_flight;
          running.player->gpuTimes(done, times[done]);
          if (repeat > 0 && times[done].frame > found.slowest.milliseconds) {
            found.slowest = {done, times[done].frame, running.player->spans(done)};
          }
        }
      }
      lastGpuTimes(*running.player, times);
    } catch (const Interrupted&) {
      lastGpuTimes(*running.player, times);
      keepCounts();
      throw;
    } catch (...) {
      keepCounts();
      throw;
    }
    keepCounts();
    if (repeat > 0) running.replays.push_back(std::move(times));
    running.broken.clear();
  }

  /// Of the frames that are still under way.
  void lastGpuTimes(WalkPlayer& player, std::vector<FrameTimes>& times) const {
    const auto all = uint32_t(times.size());
    for (uint32_t frame = all - std::min(all, options_.in_flight - 1); frame < all; ++frame) {
      player.gpuTimes(frame, times[frame]);
    }
  }

  void keepTimes(size_t method) {
    const Running& running = running_[method];
    MethodReplay& found = result_.methods[method];
    found.repeats = uint32_t(running.replays.size());
    if (running.replays.empty()) {
      found.warm_up = running.broken.empty() && !running.warm_up.empty();
      found.times = found.warm_up ? running.warm_up : running.broken;
      return;
    }
    for (size_t frame = 0; frame < frames_.cameras.size(); ++frame) {
      found.times.push_back(medianTimes(running.replays, frame));
    }
  }

  void check(size_t method) {
    WalkPlayer& player = *running_[method].player;
    MethodReplay& found = result_.methods[method];
    const bool on_gpu = walkMethod(found.name).on_gpu;
    if (!options_.check && !on_gpu && options_.shown_frames.empty()) {
      done_ += frames_.cameras.size();
      return;
    }
    player.forget();
    PopWatch pops;
    try {
      for (uint32_t frame = 0; frame < frames_.cameras.size(); ++frame) {
        step(found.name, options_.check ? "check" : "count", frame);
        FrameTimes ignored;
        player.draw(frames_.cameras[frame], frame, 1, ignored);
        if (on_gpu) found.counts.push_back(player.counts());
        if (std::ranges::find(options_.shown_frames, frame) != options_.shown_frames.end()) {
          found.drawn.push_back(player.drawn());
        }
        if (!options_.check) continue;
        const FrameCheck check = player.check();
        std::vector<size_t> wrong;
        if (check.false_pixels > 0) wrong = player.falsePixels();
        found.checks.push_back(summary(check, frame, wrong, player));
        pops.frame(frame, check.missing);
        keepWorst(found, frame, std::move(wrong));
        if (method == 0) traceFrame(frame, player);
      }
    } catch (...) {
      pops.end(found);
      throw;
    }
    pops.end(found);
  }

  CheckedFrame summary(const FrameCheck& check, uint32_t frame, std::span<const size_t> wrong,
                       WalkPlayer& player) {
    CheckedFrame result{check.false_pixels,   check.near_pixels,  check.largest(),
                        check.missing.size(), check.shown.size(), 0};
    const Camera& camera = frames_.cameras[frame];
    result.largest_region = largestRegion(camera.size, wrong);
    if (!wrong.empty() && cover_.any())
      result.behind_alpha = cover_.count(camera, wrong, player.referenceDepth());
    for (const uint32_t drawable : check.shown) {
      result.optimal_triangles += scene_.draw.drawables.list[drawable].triangle_count;
    }
    return result;
  }

  void keepWorst(MethodReplay& found, uint32_t frame, std::vector<size_t> wrong) const {
    const auto worse = [](const FalseFrame& a, const FalseFrame& b) {
      return a.pixels.size() > b.pixels.size();
    };
    const bool full = found.worst.size() >= options_.kept_frames;
    if (wrong.empty() || options_.kept_frames == 0) return;
    if (full && wrong.size() <= found.worst.back().pixels.size()) return;
    FalseFrame now{frame, std::move(wrong)};
    found.worst.insert(std::upper_bound(found.worst.begin(), found.worst.end(), now, worse), std::move(now));
    if (found.worst.size() > options_.kept_frames) found.worst.pop_back();
  }

  void traceFrame(uint32_t frame, WalkPlayer& player) {
    if (tracer_ == nullptr || options_.trace_every == 0 || frame % options_.trace_every != 0) return;
    result_.traced.push_back(traceOptimal(*tracer_, scene_.draw.drawables, frames_.cameras[frame], frame,
                                          player.referenceDrawables(), clock_));
  }

  WalkDevice& device_;
  const WalkScene& scene_;
  const WalkFrames& frames_;
  const ReplayOptions& options_;
  Tracer* tracer_;
  const WalkClock& clock_;
  const ReplayHooks& hooks_;
  AlphaCover cover_;
  std::vector<Running> running_;
  WalkReplay result_;
  uint64_t done_ = 0, all_ = 0;
};

}  // namespace

WalkReplay replayWalk(WalkDevice& device, const WalkScene& scene, const WalkFrames& frames,
                      const std::vector<std::string>& methods, const ReplayOptions& options, Tracer* tracer,
                      const WalkClock& clock, const ReplayHooks& hooks) {
  return Replayer(device, scene, frames, options, tracer, clock, hooks).run(methods);
}

}  // namespace sightline

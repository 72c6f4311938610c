#pragma once
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <thread>
#include <vector>

#include "tests/bench/trace_contestants.h"

// Contestants in turns: their times, and whether they hit the same.
namespace sightline {

struct RaceOptions {
  int runs = 5;                 ///< that count; one more warms up
  bool processor_time = false;  ///< of all threads, instead of the time that passed
  bool json = false;            ///< a line of JSON each, instead of a table's
};

inline double now(bool processor_time) {
  timespec time{};
  clock_gettime(processor_time ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return double(time.tv_sec) + double(time.tv_nsec) * 1e-9;
}

/// Wall time, or the processor time of all threads divided by the number of cores.
inline double secondsOf(const std::function<void()>& work, bool processor_time) {
  const double start = now(processor_time);
  work();
  return (now(processor_time) - start) / (processor_time ? std::thread::hardware_concurrency() : 1);
}

/// How hits compare with the last contestant's (Embree, which breaks ties as it likes and has no double
/// path).
struct Agreement {
  size_t equal = 0, ties = 0, other = 0;
};

inline Agreement compare(const std::vector<Hit>& hits, const std::vector<Hit>& peer) {
  Agreement result;
  for (size_t i = 0; i < hits.size(); ++i) {
    const bool miss = hits[i].triangle == kNoTriangle, peer_miss = peer[i].triangle == kNoTriangle;
    if (hits[i].triangle == peer[i].triangle) {
      ++result.equal;
    } else if (!miss && !peer_miss && std::fabs(hits[i].t - peer[i].t) <= 1e-5f * peer[i].t) {
      ++result.ties;
    } else {
      ++result.other;
    }
  }
  return result;
}

/// Traces the random or the border rays, so many, and prints a line a contestant. The last is the peer.
inline void race(const RaceOptions& options, std::vector<Contestant>& contestants, bool border, size_t rays) {
  std::vector<std::vector<double>> seconds(contestants.size());
  for (int run = -1; run < options.runs; ++run) {
    for (size_t i = 0; i < contestants.size(); ++i) {
      const double s = secondsOf(border ? contestants[i].trace_border : contestants[i].trace_random,
                                 options.processor_time);
      if (run >= 0) seconds[i].push_back(s);
    }
  }
  const auto hits_of = [&](Contestant& c) { return border ? c.border_hits() : c.random_hits(); };
  const std::vector<Hit> peer = hits_of(contestants.back());
  const bool has_embree = contestants.back().name == "embree";
  const char* kind = border ? "border" : "random";
  for (std::vector<double>& s : seconds) std::sort(s.begin(), s.end());
  const auto median = [&](size_t i) { return seconds[i][seconds[i].size() / 2]; };
  for (size_t i = 0; i < contestants.size(); ++i) {
    const double speed = double(rays) / median(i) / 1e6;
    const double ratio = has_embree ? median(contestants.size() - 1) / median(i) : 0;
    const double spread = (seconds[i].back() - seconds[i].front()) / median(i);
    const Agreement agreement = compare(hits_of(contestants[i]), peer);
    const double equal = double(agreement.equal) / double(rays);
    if (options.json) {
      fmt::print(
          "{{\"device\":\"{}\",\"rays\":\"{}\",\"mrays_per_s\":{:.3f},\"ratio_to_embree\":{},"
          "\"spread\":{:.3f},\"equal_hits\":{:.7f},\"ties\":{},\"other_differences\":{},\"count\":{}}}\n",
          contestants[i].name, kind, speed, has_embree ? fmt::format("{:.3f}", ratio) : "null", spread, equal,
          agreement.ties, agreement.other, rays);
    } else {
      fmt::print("{:<8} {:<8} {:>8.2f} {:>10} {:>8.1f} {:>12.5f} {:>9} {:>9}\n", contestants[i].name, kind,
                 speed, has_embree ? fmt::format("{:.2f}", ratio) : "-", 100 * spread, 100 * equal,
                 agreement.ties, agreement.other);
    }
    std::fflush(stdout);
  }
}

}  // namespace sightline

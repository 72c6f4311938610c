#include "core/gvs/iteration_forecast.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sightline {
namespace {

/// The first iterations find most of all, and are no part of the fall.
constexpr size_t kFirst = 3;
/// An iteration of the first eight that finds thirty times the threshold is none yet either: exploration is
/// still at work on what came in sight.
constexpr size_t kEarly = 8;
constexpr double kMuch = 30;
/// Variance of the logarithm of what an iteration finds, beyond that of a Poisson distribution: triangles
/// come into sight together with their neighbours.
constexpr double kClusters = 0.04;
/// Before it is measured, the power is -1, with a standard deviation of 1 / sqrt(this).
constexpr double kPrior = 4;
/// A fall slower than with this power would never end.
constexpr double kSlowestFall = -0.3;
/// Longer forecasts are of no use.
constexpr double kLongest = 1e6;

/// found(i) = found_now * (i / now) ^ power.
struct Fall {
  double now, found_now, power;
};

/// Regression of log(found) over log(iteration) in the later half of the iterations, weighted by what is
/// known of each one's scatter.
Fall fitFall(const std::vector<uint32_t>& found) {
  const auto now = double(found.size());
  const size_t begin = std::min(std::max(kFirst, found.size() / 2), found.size() - 1);
  double weights = 0, x_mean = 0, y_mean = 0;
  const auto forEach = [&](auto&& book) {
    for (size_t i = begin; i < found.size(); ++i) {
      const double count = std::max(1.0, double(found[i]));
      book(1 / (1 / count + kClusters), std::log(double(i + 1) / now), std::log(count));
    }
  };
  forEach([&](double weight, double x, double y) {
    weights += weight;
    x_mean += weight * x;
    y_mean += weight * y;
  });
  x_mean /= weights;
  y_mean /= weights;
  double xx = 0, xy = 0;
  forEach([&](double weight, double x, double y) {
    xx += weight * (x - x_mean) * (x - x_mean);
    xy += weight * (x - x_mean) * (y - y_mean);
  });
  const double power = std::min(kSlowestFall, (xy - kPrior) / (xx + kPrior));
  return {now, std::exp(y_mean - power * x_mean), power};
}

/// Probability that an iteration finds fewer than the threshold where `mean` are expected: it ends the bake.
double endChance(double mean, uint32_t threshold) {
  const double deviation = std::sqrt(std::max(1.0, mean + kClusters * mean * mean));
  return 0.5 * std::erfc((mean - (threshold - 0.5)) / deviation / std::numbers::sqrt2);
}

}  // namespace

void IterationForecast::add(uint32_t found, double seconds) {
  found_.push_back(found);
  seconds_.push_back(seconds);
}

bool IterationForecast::foretells(uint32_t threshold) const {
  if (found_.empty()) return false;
  if (found_.back() < threshold) return true;
  return found_.size() > kFirst && (found_.size() >= kEarly || found_.back() < kMuch * threshold);
}

double IterationForecast::due(uint32_t threshold, double chance) const {
  if (!foretells(threshold)) return 1;
  if (found_.back() < threshold) return 0;
  const Fall fall = fitFall(found_);
  // In strides, for there may be very many.
  double iterations = 0, goes_on = 1;
  while (goes_on > 1 - chance && iterations < kLongest) {
    const double stride = std::max(1.0, std::floor(iterations / 32));
    iterations += stride;
    const double mean = fall.found_now * std::pow(1 + iterations / fall.now, fall.power);
    goes_on *= std::pow(1 - endChance(mean, threshold), stride);
  }
  return iterations;
}

double IterationForecast::secondsEach(uint32_t threshold) const {
  if (seconds_.empty()) return 0;
  if (!foretells(threshold)) return std::ranges::min(seconds_);
  const size_t later = std::max<size_t>(1, seconds_.size() - 1);
  const size_t last = std::min(later, std::max<size_t>(2, seconds_.size() / 4));
  return std::accumulate(seconds_.end() - std::ptrdiff_t(last), seconds_.end(), 0.0) / double(last);
}

}  // namespace sightline

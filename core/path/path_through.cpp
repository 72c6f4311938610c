#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/error.h"
#include "core/path/camera_path.h"

namespace sightline {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw Error("path: " + what, kExitUsage);
}

/// Points and, from the first on, the length of the way to each.
struct Way {
  std::vector<glm::dvec3> points;
  std::vector<double> lengths;

  glm::dvec3 direction(size_t line) const {
    return (points[line + 1] - points[line]) / (lengths[line + 1] - lengths[line]);
  }
  size_t lines() const { return points.size() - 1; }
};

Way wayThrough(const std::vector<glm::dvec3>& points) {
  Way way;
  for (size_t i = 0; i < points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(points[i][axis])) refuse(fmt::format("point {} is not finite", i + 1));
    }
    if (i > 0 && points[i] == points[i - 1]) continue;
    const glm::dvec3 step = way.points.empty() ? glm::dvec3(0) : points[i] - way.points.back();
    const double before = way.lengths.empty() ? 0 : way.lengths.back();
    way.points.push_back(points[i]);
    way.lengths.push_back(before + std::sqrt(glm::dot(step, step)));
  }
  if (way.points.size() < 2) refuse("takes two different points or more");
  if (!std::isfinite(way.lengths.back())) refuse("its points are too far apart");
  for (size_t i = 0; i + 1 < way.points.size(); ++i) {
    if (way.lengths[i] < way.lengths[i + 1]) continue;
    refuse(fmt::format("two of its points are too near to each other, at {:g},{:g},{:g}", way.points[i].x,
                       way.points[i].y, way.points[i].z));
  }
  return way;
}

/// The camera turns within this share of a line before and behind a point, twice as far off begins to: two
/// keys that look the same way keep all between them straight.
constexpr double kTurnShare = 1.0 / 16;

double lengthOf(const glm::dvec3& v) {
  return std::sqrt(glm::dot(v, v));
}

/// Where the camera looks from a point between two lines: between their directions; where it turns round, to
/// the side.
glm::dvec3 lookBetween(const glm::dvec3& before, const glm::dvec3& after) {
  constexpr double kTurnsRound = 1e-3;  // of the sum of two directions of length 1
  const glm::dvec3 between = before + after;
  if (lengthOf(between) > kTurnsRound) return between / lengthOf(between);
  const glm::dvec3 side = glm::cross(before, glm::dvec3(0, 1, 0));
  return lengthOf(side) > kTurnsRound ? side / lengthOf(side) : glm::dvec3(1, 0, 0);
}

/// A place on the way that becomes a key; one between points only if a frame is left for it.
struct Stop {
  double length;  // of the way to it
  PathPlace at;
  bool is_point;
};

/// Of the points first .. last.
std::vector<Stop> stopsOf(const Way& way, size_t first, size_t last) {
  std::vector<Stop> stops;
  const auto add = [&](double length, const glm::dvec3& eye, const glm::dvec3& direction, bool is_point) {
    stops.push_back({length, {eye, eye + direction}, is_point});
  };
  for (size_t i = first; i <= last; ++i) {
    const size_t before = i > first ? i - 1 : std::min(i, way.lines() - 1), after = i < last ? i : before;
    add(way.lengths[i], way.points[i],
        before == after ? way.direction(before) : lookBetween(way.direction(before), way.direction(after)),
        true);
    for (const double share : {kTurnShare, 2 * kTurnShare, 1 - 2 * kTurnShare, 1 - kTurnShare}) {
      if (i == last) continue;
      add(std::lerp(way.lengths[i], way.lengths[i + 1], share),
          way.points[i] + share * (way.points[i + 1] - way.points[i]), way.direction(i), false);
    }
  }
  return stops;
}

/// The points first .. last in the frames from .. to.
void addStretch(const Way& way, size_t first, size_t last, uint32_t from, uint32_t to, CameraPath& path) {
  if (to - from < last - first) {
    refuse(fmt::format("{} frames are too few for {} points; give more --frames", to - from + 1,
                       last - first + 1));
  }
  const double length = way.lengths[last] - way.lengths[first];
  const auto frameAt = [&](double at) {
    return from +
           (length == 0 ? 0 : uint32_t(std::floor((at - way.lengths[first]) / length * (to - from) + 0.5)));
  };
  const std::vector<Stop> stops = stopsOf(way, first, last);
  std::vector<uint32_t> point_frames;
  for (size_t i = first; i <= last; ++i) {
    uint32_t frame = frameAt(way.lengths[i]);
    if (i > first) frame = std::max(frame, point_frames.back() + 1);
    point_frames.push_back(std::min(frame, to - uint32_t(last - i)));  // leave one to each that follows
  }
  size_t point = 0;
  for (const Stop& stop : stops) {
    if (stop.is_point) {
      path.keys.push_back({point_frames[point++], stop.at});
      continue;
    }
    const uint32_t frame = frameAt(stop.length);
    if (frame > path.keys.back().frame && frame < point_frames[point]) path.keys.push_back({frame, stop.at});
  }
}

/// The line on which the camera is in a frame, had it no cuts.
size_t lineAt(const Way& way, uint32_t frame, uint32_t frames) {
  const double length = way.lengths.back() * (double(frame) / double(frames - 1));
  const auto after = std::upper_bound(way.lengths.begin() + 1, way.lengths.end() - 1, length);
  return size_t(after - way.lengths.begin()) - 1;
}

}  // namespace

CameraPath pathThrough(const PathThrough& wanted) {
  if (wanted.frames < 2 || wanted.frames > kMostPathFrames) {
    refuse(fmt::format("{} frames is not between 2 and {}", wanted.frames, kMostPathFrames));
  }
  const Way way = wayThrough(wanted.points);
  CameraPath path{.fov = wanted.fov, .keys = {}, .cuts = wanted.cuts};
  size_t first = 0;
  uint32_t from = 0;
  for (const uint32_t cut : wanted.cuts) {
    if (cut <= from || cut >= wanted.frames) {
      refuse(fmt::format("a cut at frame {} is not between frames {} and {}", cut, from, wanted.frames));
    }
    const size_t line = lineAt(way, cut, wanted.frames);
    if (line < first) refuse(fmt::format("the cut at frame {} is on the same line as the one before", cut));
    addStretch(way, first, line, from, cut - 1, path);
    first = line + 1;
    from = cut;
  }
  addStretch(way, first, way.points.size() - 1, from, wanted.frames - 1, path);
  if (path.frames() < wanted.frames) {  // the last stretch is one point: it stays
    path.keys.push_back({wanted.frames - 1, path.keys.back().at});
  }
  if (const auto problem = pathProblem(path)) refuse(problem->place + ": " + problem->what);
  return path;
}

}  // namespace sightline

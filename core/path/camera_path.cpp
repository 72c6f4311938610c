#include "core/path/camera_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/extents.h"

namespace sightline {
namespace {

using Problem = std::optional<PathProblem>;

Problem vectorProblem(const std::string& place, const glm::dvec3& value) {
  for (int i = 0; i < 3; ++i) {
    const std::string element = fmt::format("{}[{}]", place, i);
    if (!std::isfinite(value[i])) return PathProblem{element, "is not a finite number"};
    if (std::fabs(value[i]) > kLargestCoordinate) {
      return PathProblem{element, fmt::format("{} is farther than 2^40 from the origin", value[i])};
    }
  }
  return {};
}

Problem frameProblem(const std::vector<PathKey>& keys, size_t i) {
  const std::string place = fmt::format("keys[{}].frame", i);
  const uint32_t frame = keys[i].frame;
  if (i == 0 && frame != 0) {
    return PathProblem{place, fmt::format("is {}; the first key is at frame 0", frame)};
  }
  if (i > 0 && frame <= keys[i - 1].frame) {
    return PathProblem{
        place, fmt::format("{} is not above {}, the frame of the key before it", frame, keys[i - 1].frame)};
  }
  if (frame >= kMostPathFrames) {
    // Without the number: of larger ones than fit, whoever read them knows only that they are past the limit.
    return PathProblem{place,
                       fmt::format("is past {}, the last frame that a path may have", kMostPathFrames - 1)};
  }
  return {};
}

Problem keyProblem(const std::vector<PathKey>& keys, size_t i) {
  if (auto problem = frameProblem(keys, i)) return problem;
  const PathPlace& at = keys[i].at;
  if (auto problem = vectorProblem(fmt::format("keys[{}].eye", i), at.eye)) return problem;
  if (auto problem = vectorProblem(fmt::format("keys[{}].look", i), at.look)) return problem;
  if (at.eye == at.look) {
    return PathProblem{fmt::format("keys[{}].look", i), "is the eye's place; there is nothing to look at"};
  }
  return {};
}

Problem cutProblem(const CameraPath& path, size_t i) {
  const std::string place = fmt::format("cuts[{}]", i);
  const uint32_t cut = path.cuts[i];
  if (i > 0 && cut <= path.cuts[i - 1]) {
    return PathProblem{place, fmt::format("{} is not above {}, the cut before it", cut, path.cuts[i - 1])};
  }
  const bool keyed = std::ranges::binary_search(path.keys, cut, {}, &PathKey::frame);
  if (cut == 0 || !keyed) {
    return PathProblem{place, fmt::format("there is no key at frame {} that the camera could jump to", cut)};
  }
  return {};
}

/// Between keys, a frame in which the eye passes the point that it looks at.
Problem meetingProblem(const CameraPath& path) {
  size_t key = 0;
  for (uint32_t frame = 0; frame < path.frames(); ++frame) {
    while (key + 1 < path.keys.size() && path.keys[key + 1].frame <= frame) ++key;
    const PathPlace at = placeAt(path, frame);
    if (at.eye != at.look) continue;
    return PathProblem{fmt::format("keys[{}]", key),
                       fmt::format("in frame {}, after it, the eye is where it looks; move a look point away "
                                   "from the path",
                                   frame)};
  }
  return {};
}

bool isCut(const CameraPath& path, uint32_t frame) {
  return std::ranges::binary_search(path.cuts, frame);
}

/// What the curve of one of a key's two points needs of a stretch of keys.
class Curve {
 public:
  Curve(const CameraPath& path, glm::dvec3 PathPlace::*point) : path_(path), point_(point) {}

  /// Between key i and the next, at a share of the way.
  glm::dvec3 at(size_t i, double share) const {
    const double length = between(i, i + 1), s = share, left = 1 - share;
    const glm::dvec3 from = value(i), to = value(i + 1);
    // Hermite's cubic, so that what rests stays where it is to the last bit.
    return from + (to - from) * (s * s * (3 - 2 * s)) + slope(i) * (length * (s * left * left)) -
           slope(i + 1) * (length * (s * s * left));
  }

 private:
  glm::dvec3 value(size_t i) const { return path_.keys[i].at.*point_; }
  double between(size_t i, size_t j) const { return double(path_.keys[j].frame) - path_.keys[i].frame; }
  bool joins(size_t i) const {  // key i - 1 and i are of one stretch
    return i > 0 && i < path_.keys.size() && !isCut(path_, path_.keys[i].frame);
  }
  glm::dvec3 slope(size_t i) const {
    const size_t low = joins(i) ? i - 1 : i, high = joins(i + 1) ? i + 1 : i;
    const bool rests = (low < i && value(low) == value(i)) || (high > i && value(high) == value(i));
    if (low == high || rests) return glm::dvec3(0);
    return (value(high) - value(low)) / between(low, high);
  }

  const CameraPath& path_;
  glm::dvec3 PathPlace::*point_;
};

}  // namespace

std::optional<PathProblem> pathProblem(const CameraPath& path) {
  if (!(path.fov >= kSmallestPathFov && path.fov <= kLargestPathFov)) {
    return PathProblem{"fov", fmt::format("{} is not between {} and {} degrees", path.fov, kSmallestPathFov,
                                          kLargestPathFov)};
  }
  if (path.keys.empty()) return PathProblem{"keys", "is empty; at least one key is needed"};
  for (size_t i = 0; i < path.keys.size(); ++i) {
    if (auto problem = keyProblem(path.keys, i)) return problem;
  }
  for (size_t i = 0; i < path.cuts.size(); ++i) {
    if (auto problem = cutProblem(path, i)) return problem;
  }
  return meetingProblem(path);
}

PathPlace placeAt(const CameraPath& path, uint32_t frame) {
  const auto after = std::ranges::upper_bound(path.keys, frame, {}, &PathKey::frame);
  const auto i = size_t(after - path.keys.begin()) - 1;
  const PathKey& key = path.keys[i];
  if (after == path.keys.end() || frame == key.frame || isCut(path, after->frame)) return key.at;
  const double share = double(frame - key.frame) / double(after->frame - key.frame);
  return {Curve(path, &PathPlace::eye).at(i, share), Curve(path, &PathPlace::look).at(i, share)};
}

bool startsStretch(const CameraPath& path, uint32_t frame) {
  return frame == 0 || isCut(path, frame);
}

CameraPath moved(CameraPath path, const glm::dvec3& by) {
  for (PathKey& key : path.keys) {
    key.at.eye += by;
    key.at.look += by;
  }
  return path;
}

}  // namespace sightline

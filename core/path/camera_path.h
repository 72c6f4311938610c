#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sightline {

/// Most frames of a path: more is a mistake in the file, not a walk.
inline constexpr uint32_t kMostPathFrames = 1'000'000;

/// Fields of view of a path, degrees from the top of the image to its bottom.
inline constexpr double kDefaultPathFov = 60, kSmallestPathFov = 1, kLargestPathFov = 179;

/// Where the camera is in a frame, and a point that it looks at.
struct PathPlace {
  glm::dvec3 eye{0.0}, look{0.0};  ///< the scene file's coordinates

  bool operator==(const PathPlace&) const = default;
};

struct PathKey {
  uint32_t frame = 0;
  PathPlace at = {};

  bool operator==(const PathKey&) const = default;
};

/// How a camera moves: places at some frames, and frames at which it jumps. As in the walk file (walk.json):
/// {"fov":60,"keys":[{"frame":0,"eye":[x,y,z],"look":[x,y,z]}, ...],"cuts":[1200]}
struct CameraPath {
  double fov = kDefaultPathFov;
  std::vector<PathKey> keys;   ///< the first at frame 0, ascending
  std::vector<uint32_t> cuts;  ///< ascending; there is a key at each, and the camera jumps to it: up to the
                               ///< frame before, it stands where the key before is

  /// Frames 0 .. frames() - 1; the last key is the last of them.
  uint32_t frames() const { return keys.empty() ? 0 : keys.back().frame + 1; }

  bool operator==(const CameraPath&) const = default;
};

/// What is wrong with a path, and where: "keys[3].eye[1]", "is not a finite number".
struct PathProblem {
  std::string place, what;
};

/// The first thing that makes a path no path: no keys; frames that do not begin at 0, do not ascend or are
/// too many; numbers that are not finite or too large (kLargestCoordinate); a field of view out of range; a
/// cut without a key; a frame in which the eye is where it looks, at a key or between two. Nothing: it is
/// sound.
std::optional<PathProblem> pathProblem(const CameraPath& path);

/// The place in a frame below frames(), of a sound path: a pure function of the path, from +, -, * and /
/// alone, so that it is the same, bit for bit, on every machine.
///
/// Based on: E. Catmull and R. Rom, A class of local interpolating splines, 1974. Eye and look each follow a
/// cubic between two keys, whose slope at a key is that from the key before to the key after, by frames. At
/// the ends of the path and beside a cut it is that to the only neighbour; and where two keys in a row have
/// the same eye (or look), it rests between them: slope 0.
PathPlace placeAt(const CameraPath& path, uint32_t frame);

/// Whether the camera jumps to this frame: the first one, or a cut.
bool startsStretch(const CameraPath& path, uint32_t frame);

/// The path, moved by as much: from a file's coordinates to those of a scene with an offset, or back.
CameraPath moved(CameraPath path, const glm::dvec3& by);

/// A path of straight lines through points, at an even speed, looking ahead. It turns at the points, within
/// an eighth of each line, where the curve leaves the lines by less than a tenth of that.
struct PathThrough {
  std::vector<glm::dvec3> points;  ///< two or more; those in a row that are the same count once
  uint32_t frames = 0;             ///< at least one a point, at most kMostPathFrames
  double fov = kDefaultPathFov;
  /// Frames at which the camera jumps: the line between two points on which it would be then is left out.
  /// Ascending, each on another line.
  std::vector<uint32_t> cuts = {};
};

/// Throws Error (exit code 2) that says what is wrong with the points, frames or cuts.
CameraPath pathThrough(const PathThrough& wanted);

}  // namespace sightline

#pragma once
#include <cstdint>

#include "core/path/camera_path.h"

namespace sightline {

/// Share of a walk, 0 .. 1, at which its parts begin: of all generated scenes the same, so that their figures
/// can be read next to each other.
inline constexpr double kTurnFrom = 0.25, kTurnTo = 0.27, kSecondTo = 0.45;
inline constexpr double kSideFrom = 0.5, kSideTo = 0.68, kRiseFrom = 0.7;

/// Collects the keys of a generated walk by the share of it at which they stand.
class WalkPlan {
 public:
  explicit WalkPlan(uint32_t frames) : frames_(frames) {}

  /// A key; left out where the key before it has taken the frame.
  void key(double share, const glm::dvec3& eye, const glm::dvec3& look);
  /// The camera jumps to this key.
  void cut(double share, const glm::dvec3& eye, const glm::dvec3& look);
  /// Turns about y on the spot: headings in degrees, 0 along +z, 90 along +x.
  void turn(double from, double to, const glm::dvec3& eye, double from_heading, double to_heading);
  /// From where the last key is, up and back until a scene about `middle` as large as `extent` is seen whole
  /// in an image that is at least as wide as high. away: level direction of length 1.
  void seeAll(const glm::dvec3& middle, double extent, const glm::dvec3& away);

  CameraPath path() const { return path_; }

 private:
  uint32_t frameAt(double share) const;

  uint32_t frames_;
  CameraPath path_;
};

}  // namespace sightline

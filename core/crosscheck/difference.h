#pragma once
#include <string>

#include "core/judge/ruling.h"

namespace sightline {

/// How a device's answer differs from another's.
enum class Difference : uint8_t {
  kSame,    ///< the same triangle, or nothing both times
  kTie,     ///< another triangle at an equal distance (4 units in the last place of float)
  kEdge,    ///< its neighbour: they share an edge or a corner that the ray meets
  kMissed,  ///< one of the two hits nothing
  kWrong,   ///< another triangle somewhere else
  kGlass,   ///< the same triangle, but before it other glass that the ray sees
};
inline constexpr uint32_t kDifferences = 6;

/// "same", "tie", "edge", "missed", "wrong", "glass".
std::string differenceName(Difference difference);
/// "right", "rounded", "missed", "wrong".
std::string verdictName(Verdict verdict);

/// How answer b differs from a. Triangles are neighbours where corners have the same positions; the ray meets
/// what they share if it passes within the limit's float steps of it. Neighbours are not counted as ties.
/// Never kGlass: that is about more than what ends the ray.
Difference differenceOf(const Judge& judge, const Ray& ray, const Hit& a, const Hit& b,
                        const RoundingLimit& limit);

}  // namespace sightline

#pragma once

// How far and how small what we trace may be.
namespace sightline {

/// Coordinates of scenes and view cells reach so far at most, to either side of 0: products of three
/// distances, which the intersection test takes, must stay within single precision.
inline constexpr float kLargestCoordinate = 0x1p40f;

/// No scene's extent and no extent of a view cell (but 0) is below this: smaller ones leave the normal floats
/// where distances are multiplied.
inline constexpr float kSmallestExtent = 0x1p-60f;

}  // namespace sightline

#pragma once
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/cell/view_cell.h"
#include "core/device/device.h"
#include "core/scene/scene.h"
#include "core/shared/reverse.h"

namespace sightline {

/// Kinds of rays that devices are compared on. The first three are those of a bake, the others are made to
/// break tracers.
enum class RayKind : uint8_t {
  kRandom,     ///< of random sampling
  kBorder,     ///< of border sampling
  kReverse,    ///< of reverse sampling
  kVertex,     ///< from the cell to a corner
  kEdge,       ///< from the cell to a point of an edge
  kAlongEdge,  ///< along an edge, from before it or from its end
  kAxis,       ///< along a coordinate axis, to a corner, a point of an edge or of a triangle
  kGrazing,    ///< to a point of a triangle, at a slope of 1 : 10 to 1 : 10^7
  kPlane,      ///< from a point of a triangle, to a corner or in its plane
  kFarTiny,    ///< to a corner of a small triangle, from many times the scene's size away
};
inline constexpr uint32_t kRayKinds = 10;

/// "random", "border", ..., "far-tiny".
std::string rayKindName(RayKind kind);
std::optional<RayKind> rayKindOf(const std::string& name);

/// Whether a ray of this kind ends, at t = 1, on a triangle: an answer that is farther is suspicious.
bool isAimed(RayKind kind);

/// Makes the rays of one view cell, each for itself: ray i of a kind depends on scene, cell, seed and i
/// alone.
class RayMaker {
 public:
  /// Bakes the cell on `device` with few rays, and traces border rays, so that rays of border and reverse
  /// sampling and targets that can be seen are known. scene must outlive it. rays: how many of a kind will be
  /// asked for. Throws Error; Interrupted when *stop becomes true.
  RayMaker(const Scene& scene, const ViewCell& cell, uint32_t cell_index, Device& device, uint64_t seed,
           uint64_t rays, const std::atomic<bool>* stop);

  /// Fills rays with those of the numbers first, first + 1, ... A direction of zero: there is none.
  void make(RayKind kind, uint64_t first, std::span<Ray> rays) const;

 private:
  Ray ray(RayKind kind, uint64_t number) const;
  void findDiscontinuities(Device& device, uint64_t rays);

  const Scene& scene_;
  std::vector<Face> faces_;
  uint64_t key_;  ///< of seed and cell
  float reach_;   ///< largest extent of scene and cell
  StageParams params_{};
  std::vector<PvsEntry> entries_;  ///< found by rays
  std::vector<ReverseItem> discontinuities_;
};

}  // namespace sightline

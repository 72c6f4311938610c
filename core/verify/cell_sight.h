#pragma once
#include <cstdint>
#include <string>

#include "core/cell/cell_frame.h"
#include "core/judge/judge_ray.h"
#include "core/pvs/cell_pvs.h"

namespace sightline {

/// What is wrong with a triangle of a set. The first four follow from the definition of the view cell alone.
enum class Fault : uint8_t {
  kNone,
  kBehind,     ///< all of it lies behind the plane of its flat cell
  kNoRay,      ///< its witness has no direction, or is not of finite numbers
  kOffCell,    ///< its witness does not begin on the cell
  kBackwards,  ///< its witness leaves its flat cell on the side that does not look
  kNotMet,     ///< its witness does not meet it first
  kApart,      ///< it has no witness as it is said to meet the cell itself, but it does not
};
inline constexpr uint32_t kFaults = 7;
/// For JSON: "none", "behind", "no_ray", "off_cell", "backwards", "not_met", "apart".
std::string faultName(Fault fault);
/// For people, after the triangle: "its ray begins off the cell", ...
std::string faultText(Fault fault);

/// Which rays show what can be seen from a view cell, by the cell's definition:
///
///    box        ^          sheet            flat cell
///   +----------/--+           |                ^   ^   /
///   |         o   |       <---+--->            |   |  /
///   |  o---------------->  <--+--->       .....=======..... its plane:
///   +-------------+           |            nothing behind it counts
///
/// A ray begins on the cell or in it. Boxes look out of all their faces, and a ray from within leaves by one
/// of them; sheets look to both sides, flat cells along local +z only. A triangle that crosses the plane of a
/// flat cell counts by its front part.
///
/// What strays by no more than the rounding of floats passes.
class CellSight {
 public:
  explicit CellSight(const ViewCell& cell);

  const CellFrame& frame() const { return frame_; }

  /// Whether a ray that begins here begins on the cell or in it.
  bool beginsOnCell(const glm::dvec3& origin) const;
  /// Whether the cell looks along the direction.
  bool looksAlong(const glm::dvec3& direction) const;
  /// Whether all of the triangle lies behind the plane of a flat cell, by more than rounding: no ray of the
  /// cell can meet it.
  bool isBehind(const JudgeTriangle& triangle) const;

  /// What the definition has against a triangle of the set and its witness, if any.
  Fault faultOf(const JudgeTriangle& triangle, const Witness& witness) const;

 private:
  CellFrame frame_;
  bool flat_;
  glm::dvec3 slack_;  ///< by which rounding moves origins along the local axes
  double tilt_;       ///< by which rounding tilts directions out of the plane, a share of their length
};

}  // namespace sightline

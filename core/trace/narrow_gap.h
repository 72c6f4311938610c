#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/scene.h"
#include "core/shared/types.h"
#include "core/trace/tracer.h"

// Whether a ray has room on its way. Real models have hairline gaps between their walls, through which rays
// see everything behind; geometry that counts as closed where a gap is narrower than W answers the question
// "what is seen through holes wider than that".
//
//            #  wall
//         h  # p      A neighbour of a ray is one beside it, in the same direction, at the distance h = 1.02
//         W.
//   ------------->    It is stopped where it hits something by more than 4 W before the ray does. A ray is
//         h  # q      pinched if, for one of eight directions, 22.5 degrees apart, in the plane of a wall
//         beside
//            #        it, the neighbours on both sides are stopped, at p and at q, and p is no farther than
//                     2.01 h from the triangle that q lies on, or q from that of p.
//
// The walls beside it are looked for by neighbours in eight directions across the ray: where both are
// stopped, the nearer of the two triangles is one. What follows:
// - A ray through a straight gap, or a hole of any convex shape, in a wall of any thickness that is narrower
// than
//   W is pinched, at whatever slant, wherever in the gap it runs: both rims are within h, and one of the
//   directions in the wall is within 11.25 degrees of the narrowest (1.02 cos 11.25 = 1).
// - A ray through the middle of one that is wider than 2.05 W is not: in the wall's plane one neighbour at
// least
//   misses the rims; and what else stops it, in a thick wall the gap's own side, is farther than 2.01 h from
//   the other rim.
// - Corners are no gaps: of two walls that meet at more than 29 degrees the neighbours stop by at most 4 W
// before
//   the ray. What lies less than 4 W behind a gap counts as part of its rims, and a gap that lies nearer than
//   W to where the ray begins may be passed: cells keep that far from walls.
namespace sightline {

/// What stands on both sides of a ray.
struct Pinch {
  bool pinched = false;
  Hit nearer{0, kNoTriangle};  ///< of a pinched ray: what the neighbour that is stopped first hits, t as the
                               ///< ray's own
  vec3 place{0};               ///< of a pinched ray: the middle between the places that stop its neighbours
};

/// pinches[i] says whether rays[i], which first meets hits[i], is pinched by gaps narrower than `width` (W,
/// world units, above 0). Rays that meet nothing are not. The answer depends on the tracer's hits alone; rays
/// traced: mostly 8 or 9 for each, at most 144. Returns how many. Where the width is but some steps of floats
/// at the scene's coordinates, rounding decides. tracer: of the scene. Throws Error.
uint64_t findPinched(Tracer& tracer, const Scene& scene, float width, std::span<const Ray> rays,
                     std::span<const Hit> hits, std::vector<Pinch>& pinches);

}  // namespace sightline

#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/shared/types.h"
#include "core/trace/tracer.h"

// Whether a ray has room on its way. Real models have hairline gaps between their walls, through which rays
// see everything behind; geometry that counts as closed where a gap is narrower than W answers the question
// "what is seen through holes wider than that".
//
//                 #  wall             A ray is pinched if for one of eight directions across it both of its
//   u ------------# blocked           neighbours, at the distance h = 1.02 W to either side, are stopped by
//   o ------------------->  hit       more than 4 W before its own hit.
//  -u ------------# blocked
//                 #                   All eight look along straight lines across the ray, 22.5 degrees apart.
//
// What follows: a ray through a straight gap, or a hole of any convex shape, narrower than W is pinched,
// wherever in the gap it runs: some of the eight directions is within 11.25 degrees of the narrowest, so h
// reaches both rims (1.02 cos 11.25 = 1). A ray around which a tube of radius 1.02 W is free up to 4 W before
// its hit is not: so none that goes through the middle of a hole wider than 2.04 W. Corners are no gaps: of two
// walls that meet at more than 29 degrees the neighbours stop by at most 4 W before the ray. What lies less
// than 4 W behind a gap counts as part of its rims, and a gap that lies nearer than W to where the ray begins may
// be passed: cells keep that far from walls.
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
/// traced: at most 16 for each, mostly 8 or 9. Returns how many. Where the width is but some steps of floats
/// at the scene's coordinates, rounding decides. Throws Error.
uint64_t findPinched(Tracer& tracer, float width, std::span<const Ray> rays, std::span<const Hit> hits,
                     std::vector<Pinch>& pinches);

}  // namespace sightline

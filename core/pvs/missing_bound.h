#pragma once
#include <cstdint>

namespace sightline {

/// Upper end of the two-sided 95 % interval (Clopper and Pearson 1934) of the share missing / rays, 0..1.
/// rays = 0 gives 1.
double missingUpperBound(uint64_t missing, uint64_t rays);

/// Upper end of the one-sided interval that may be wrong with probability `tail`, above 0 and below 0.5.
double missingUpperBound(uint64_t missing, uint64_t rays, double tail);

/// The fewest rays of which `missing` may miss for that bound to be below `share`, above 0 and below 1.
uint64_t raysForBound(uint64_t missing, double share, double tail);

}  // namespace sightline

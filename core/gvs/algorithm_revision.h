#pragma once
#include <cstdint>

namespace sightline {

/// Which sets this program computes, as a number that .pvs files keep: a bake is not gone on with by a
/// program of another revision, for one file must not hold cells of two algorithms. Raise it with every
/// change that may change a set, a witness or a count of some bake: sampling (core/shared, core/gvs), the
/// intersection test, the order of batches, the stop rule, what a cell contains. What only makes a bake
/// faster leaves it.
///   1: all before format 4 of .pvs files
///   2: rays leave flat cells along their normal only
inline constexpr uint32_t kAlgorithmRevision = 2;

}  // namespace sightline

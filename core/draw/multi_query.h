#pragma once
#include <cstdint>
#include <span>

namespace sightline {

/// How likely a node that has been hidden in so many answers in a row is hidden again: 0.99 - 0.7 e^-n.
double stillHidden(uint32_t hidden_frames);

/// How many nodes a query gets for its cost: count / (1 + (1 - all_hidden) count), for if any is visible, all
/// are asked about again, one by one. A query of one node is not repeated: 1. all_hidden: how likely all of
/// them are hidden.
double multiQueryValue(uint32_t count, double all_hidden);

/// How many of the first nodes to ask about at once, so that the value is greatest; of equal ones the fewest.
/// hidden: stillHidden of each, descending: then no other choice of nodes has a greater value. At least 1;
/// hidden is not empty.
///
/// Based on: CHC++ (Mattausch, Bittner and Wimmer 2008), section 4.2. Where we differ: a single node's cost
/// is 1, not 2 - its chance; by the paper's formula nodes that nothing is known of would share one query that
/// is bound to fail.
uint32_t multiQuerySize(std::span<const double> hidden);

}  // namespace sightline

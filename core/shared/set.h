// The set of found triangles, with the ray that found each: atomic insertion that keeps the lowest ray index.
//
// A triangle has a slot `winner`: kSlotEmpty, or the lowest index (1 ..) of the batch's rays that hit it, or
// kSlotOld if it was found before this batch; so a plain "keep the minimum" does everything, and the result
// does not depend on the order in which threads arrive. Who turns an empty slot into a full one sets the
// triangle's bit in `fresh`; walking these bits gives the new triangles in ascending order.
//
// Array: the slot of triangle i is i. Hash set (capacity > 0): linear probing from MurmurHash3's finaliser
// (Appleby 2011; thesis 6.2.7 and algorithm 6.4, after Farrell), bounded; what finds no slot raises
// `overflow`, and the host repeats the launch with a larger table.
#ifndef SL_SET_H
#define SL_SET_H
#include "core/shared/types.h"
SL_NAMESPACE_BEGIN

SL_CONST uint kSlotEmpty = 0xffffffffu;
SL_CONST uint kSlotOld = 0u;
SL_CONST uint kMaxProbes = 128u;

/// Finaliser of MurmurHash3, a bijection of 32 bits.
SL_FUNC uint murmurMix(uint h) {
  h ^= h >> 16;
  h *= 0x85ebca6bu;
  h ^= h >> 13;
  h *= 0xc2b2ae35u;
  h ^= h >> 16;
  return h;
}

/// The slot that holds the triangle, or kSlotEmpty where the set does not know it.
SL_FUNC uint findSlot(SL_SET_PARAM, uint triangle) {
  if (SL_SET_CAPACITY == 0u) return triangle;
  uint slot = murmurMix(triangle) & (SL_SET_CAPACITY - 1u);
  for (uint probe = 0u; probe < kMaxProbes; ++probe) {
    uint key = SL_SET_LOAD(keys, slot);
    if (key == triangle) return slot;
    if (key == kNoTriangle) return kSlotEmpty;
    slot = (slot + 1u) & (SL_SET_CAPACITY - 1u);
  }
  return kSlotEmpty;
}

/// The slot that holds the triangle from now on, or kSlotEmpty where every probed one is taken.
SL_FUNC uint claimSlot(SL_SET_PARAM, uint triangle) {
  if (SL_SET_CAPACITY == 0u) return triangle;
  uint slot = murmurMix(triangle) & (SL_SET_CAPACITY - 1u);
  for (uint probe = 0u; probe < kMaxProbes; ++probe) {
    uint key = SL_SET_LOAD(keys, slot);
    if (key == kNoTriangle) key = SL_SET_CAS(keys, slot, kNoTriangle, triangle);
    if (key == kNoTriangle || key == triangle) return slot;
    slot = (slot + 1u) & (SL_SET_CAPACITY - 1u);
  }
  return kSlotEmpty;
}

/// Whether a triangle is in the set.
SL_FUNC bool isInSet(SL_SET_PARAM, uint triangle) {
  uint slot = findSlot(SL_SET, triangle);
  return slot != kSlotEmpty && SL_SET_LOAD(winner, slot) != kSlotEmpty;
}

/// Inserts a hit (kNoTriangle: nothing to do) of the ray with this index (1 ..) in the batch.
SL_FUNC void insertHit(SL_SET_PARAM, uint triangle, uint ray_index) {
  if (triangle == kNoTriangle) return;
  uint slot = claimSlot(SL_SET, triangle);
  if (slot == kSlotEmpty) {
    SL_SET_ADD(overflow, 0u, 1u);
    return;
  }
  uint old = SL_SET_LOAD(winner, slot);
  // Every failure means that another ray lowered the slot; a thread can fail only as often as rays race it.
  for (uint attempt = 0u; ray_index < old; ++attempt) {
    if (attempt == 4096u) {
      SL_SET_ADD(overflow, 0u, 1u);
      return;
    }
    uint seen = SL_SET_CAS(winner, slot, old, ray_index);
    if (seen == old) {
      if (old == kSlotEmpty) SL_SET_OR(fresh, triangle >> 5, 1u << (triangle & 31u));
      return;
    }
    old = seen;
  }
}

SL_NAMESPACE_END
#endif

// What one work item of each list stage does on a GPU. From bits to lists, in ascending order whatever the
// scheduling: count the bits of each block of words, sum up over the blocks, write. So are listed the
// triangles that are new in a batch, and the discontinuities; border rays are numbered likewise.
SL_NAMESPACE_BEGIN

SL_FUNC void countBitsOf(SL_STAGE_PARAM, uint block) {
  uint end = min((block + 1u) * kBlockWords, SL_LAUNCH(word_count));
  uint count = 0u;
  for (uint i = block * kBlockWords; i < end; ++i) count += slBitCount(SL_BUFFER(words, i));
  SL_BUFFER(block_counts, block) = count;
}

// Sums of the block counts before each, in place, by one group of SL_SUM_ITEMS; each item has a share of the
// blocks.
SL_FUNC uint shareBegin(SL_STAGE_PARAM, uint item) {
  uint blocks = SL_LAUNCH(block_count);
  return min(item * ((blocks + SL_SUM_ITEMS - 1u) / SL_SUM_ITEMS), blocks);
}

/// What all items do first.
SL_FUNC uint sumOfShare(SL_STAGE_PARAM, uint item) {
  uint end = shareBegin(SL_STAGE, item + 1u);
  uint sum = 0u;
  for (uint i = shareBegin(SL_STAGE, item); i < end; ++i) sum += SL_BUFFER(block_counts, i);
  return sum;
}

/// What they do then. before: the sum of the shares before the item's. The total goes behind the blocks, and
/// to a counter.
SL_FUNC void writeShare(SL_STAGE_PARAM, uint item, uint before) {
  uint end = shareBegin(SL_STAGE, item + 1u);
  for (uint i = shareBegin(SL_STAGE, item); i < end; ++i) {
    uint count = SL_BUFFER(block_counts, i);
    SL_BUFFER(block_counts, i) = before;
    before += count;
  }
  if (item != SL_SUM_ITEMS - 1u) return;
  SL_BUFFER(block_counts, SL_LAUNCH(block_count)) = before;
  SL_BUFFER(counters, SL_LAUNCH(sum_place)) = before;
}

/// Writes the indices of the set bits and clears them.
SL_FUNC void writeIndicesOf(SL_STAGE_PARAM, uint block) {
  uint place = SL_BUFFER(block_counts, block);
  uint end = min((block + 1u) * kBlockWords, SL_LAUNCH(word_count));
  for (uint i = block * kBlockWords; i < end; ++i) {
    for (uint bits = SL_BUFFER(words, i); bits != 0u; bits &= bits - 1u) {
      SL_BUFFER(indices, place) = i * 32u + slLowestBit(bits);
      ++place;
    }
    SL_BUFFER(words, i) = 0u;
  }
}

/// Counts the border rays of each entry of a block of kBorderBlock, and of the block.
SL_FUNC void countBorderRaysOf(SL_STAGE_PARAM, uint block) {
  StageParams params = SL_LAUNCH(params);
  uint end = min((block + 1u) * kBorderBlock, SL_LAUNCH(border_count));
  uint rays = 0u;
  for (uint i = block * kBorderBlock; i < end; ++i) {
    uvec4 entry = SL_BUFFER(entries, SL_LAUNCH(border_first) + i).origin_triangle;
    Corners t = SL_CORNERS(entry.w);
    uint count = borderRayCount(borderSamples(t.a, t.b, t.c, vectorOfBits(entry), params), params);
    SL_BUFFER(border_starts, i) = count;
    rays += count;
  }
  SL_BUFFER(block_counts, block) = rays;
}

/// Makes of the counts of rays, and the sums before each block, the sums before each entry and of all.
SL_FUNC void sumBorderRaysOf(SL_STAGE_PARAM, uint block) {
  uint before = SL_BUFFER(block_counts, block);
  uint end = min((block + 1u) * kBorderBlock, SL_LAUNCH(border_count));
  for (uint i = block * kBorderBlock; i < end; ++i) {
    uint rays = SL_BUFFER(border_starts, i);
    SL_BUFFER(border_starts, i) = before;
    before += rays;
  }
  if (end == SL_LAUNCH(border_count)) SL_BUFFER(border_starts, end) = before;
}

/// A side of a border polygon, three an entry of the batch: many rays share one.
SL_FUNC void makeBorderEdge(SL_STAGE_PARAM, uint item) {
  uvec4 entry = SL_BUFFER(entries, SL_LAUNCH(border_first) + item / 3u).origin_triangle;
  Corners t = SL_CORNERS(entry.w);
  SL_BUFFER(border_edges, item) =
      borderEdge(t.a, t.b, t.c, item % 3u, vectorOfBits(entry), SL_LAUNCH(params));
}

/// The entry of the batch that border ray `index` belongs to. Needs what sumBorderRaysOf wrote, but for the
/// original method.
SL_FUNC uint borderEntryOf(SL_STAGE_PARAM, uint index) {
  if (isGvs(SL_LAUNCH(params))) return index / kGvsPositions;
  uint low = 0u;
  uint high = SL_LAUNCH(border_count);
  while (high - low > 1u) {
    uint middle = (low + high) / 2u;
    if (SL_BUFFER(border_starts, middle) <= index) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}

/// The same from the entry of a ray shortly before.
SL_FUNC uint nextBorderEntry(SL_STAGE_PARAM, uint entry, uint index) {
  while (entry + 1u < SL_LAUNCH(border_count) && SL_BUFFER(border_starts, entry + 1u) <= index) ++entry;
  return entry;
}

/// Which ray of its entry's polygon border ray `index` is.
SL_FUNC uint borderRayNumber(SL_STAGE_PARAM, uint index, uint entry) {
  return isGvs(SL_LAUNCH(params)) ? index - entry * kGvsPositions : index - SL_BUFFER(border_starts, entry);
}

/// Whether the border ray before `index`, on the same side, met a discontinuity by the same occluder.
SL_FUNC bool followsAnother(SL_STAGE_PARAM, uint index) {
  uint before = index - 1u;
  if ((SL_BUFFER(bits, before >> 5) >> (before & 31u) & 1u) == 0u) return false;
  return SL_BUFFER(border_hits, before) == SL_BUFFER(border_hits, index);
}

/// Of a word of the rays that met a discontinuity, those that keepsDiscontinuity names.
SL_FUNC void thinDiscontinuitiesOf(SL_STAGE_PARAM, uint word) {
  StageParams params = SL_LAUNCH(params);
  uint bits = SL_BUFFER(bits, word);
  uint entry = bits == 0u ? 0u : borderEntryOf(SL_STAGE, word * 32u);
  uint kept = 0u;
  for (; bits != 0u; bits &= bits - 1u) {
    uint bit = slLowestBit(bits);
    uint index = word * 32u + bit;
    entry = nextBorderEntry(SL_STAGE, entry, index);
    uint place = borderPlace(borderRayNumber(SL_STAGE, index, entry), borderSamplesAt(SL_STAGE, entry));
    bool follows = place > 0u && followsAnother(SL_STAGE, index);
    kept |= (keepsDiscontinuity(place, follows, params) ? 1u : 0u) << bit;
  }
  SL_BUFFER(kept_bits, word) = kept;
}

/// Appends the discontinuity of a border ray in `indices` to those that wait.
SL_FUNC void appendDiscontinuityOf(SL_STAGE_PARAM, uint item) {
  uint index = SL_BUFFER(indices, item);
  uint entry = borderEntryOf(SL_STAGE, index);
  Discontinuity discontinuity;
  discontinuity.ray = uvec4(SL_LAUNCH(border_first) + entry, borderRayNumber(SL_STAGE, index, entry),
                            SL_BUFFER(border_hits, index), borderSamplesAt(SL_STAGE, entry));
  SL_BUFFER(discontinuities, SL_LAUNCH(waiting) + item) = discontinuity;
}

/// A discontinuity of the reverse launch, with all that its rays share.
SL_FUNC void makeReverseItem(SL_STAGE_PARAM, uint item) {
  SL_BUFFER(reverse_items, item) = reverseItemAt(SL_STAGE, SL_LAUNCH(reverse_first) + item);
}

/// The ray with this index (1 ..) in the batch that is collected.
SL_FUNC Ray batchRayAt(SL_STAGE_PARAM, uint index) {
  uint stage = SL_LAUNCH(stage);
  if (stage == kStageRandom) return segmentRayAt(SL_STAGE, index);
  if (stage == kStageReverse) return reverseRayAt(SL_STAGE, index - 1u);
  uint entry = borderEntryOf(SL_STAGE, index - 1u);
  return borderRayAt(SL_STAGE, entry, borderRayNumber(SL_STAGE, index - 1u, entry));
}

/// Index of the ray that won the new triangle `item` of the batch; marks its slot as old.
SL_FUNC uint takeWinner(SL_STAGE_PARAM, uint item) {
  uint slot = findSlot(SL_STAGE_SET, SL_BUFFER(indices, item));
  uint index = SL_BUFFER(winner, slot);
  SL_BUFFER(winner, slot) = kSlotOld;
  return index;
}

/// Appends the new triangle `item` of a batch to the list, with the ray that won it.
SL_FUNC void appendEntryOf(SL_STAGE_PARAM, uint item, Ray ray) {
  SL_BUFFER(entries, SL_LAUNCH(list_end) + item) = entryOf(SL_BUFFER(indices, item), ray, SL_LAUNCH(stage));
}

/// Puts a triangle into the set and the list without a ray.
SL_FUNC void insertContainedOf(SL_STAGE_PARAM, uint item) {
  uint triangle = SL_BUFFER(indices, item);
  uint slot = claimSlot(SL_STAGE_SET, triangle);
  if (slot == kSlotEmpty) {
    SL_STAGE_ADD(counters, kOverflowCounter, 1u);
    return;
  }
  SL_BUFFER(winner, slot) = kSlotOld;
  SL_BUFFER(entries, SL_LAUNCH(list_end) + item) = entryOf(triangle, noRay(), kStageContained);
}

/// Moves a slot of a hash set into the larger one.
SL_FUNC void rehashOf(SL_STAGE_PARAM, uint old_slot) {
  uint key = SL_BUFFER(old_keys, old_slot);
  if (key == kNoTriangle) return;
  uint slot = claimSlot(SL_STAGE_SET, key);
  if (slot == kSlotEmpty) {
    SL_STAGE_ADD(counters, kOverflowCounter, 1u);
    return;
  }
  SL_BUFFER(winner, slot) = SL_BUFFER(old_winner, old_slot);
}

SL_NAMESPACE_END

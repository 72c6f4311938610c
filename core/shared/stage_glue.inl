// The rays of a batch by their index: random, border and reverse, of what lies in the stage's buffers. On the
// host the buffers are functions of an object (core/sampling/stage_rays.h), on GPUs memory (stage_launch.h).
SL_NAMESPACE_BEGIN

/// Samples between the ends of the long edges of the polygon of the batch's entry.
SL_FUNC uint borderSamplesAt(SL_STAGE_PARAM, uint entry) {
  return slUint(SL_BUFFER(border_edges, entry * 3u).bisector.w);
}

/// Border ray k of the batch's entry.
SL_FUNC Ray borderRayAt(SL_STAGE_PARAM, uint entry, uint k) {
  StageParams params = SL_LAUNCH(params);
  vec3 origin = vectorOfBits(SL_BUFFER(entries, SL_LAUNCH(border_first) + entry).origin_triangle);
  if (isGvs(params)) {
    uint first = gvsFirstVertex(k);
    uint second = gvsSecondVertex(k);
    vec3 from = gvsVertexOf(SL_BUFFER(border_edges, entry * 3u + first / 3u), first);
    vec3 to = gvsVertexOf(SL_BUFFER(border_edges, entry * 3u + second / 3u), second);
    return gvsBorderRay(from, to, k, origin, params);
  }
  uint side = borderSide(k, borderSamplesAt(SL_STAGE, entry));
  return borderRay(SL_BUFFER(border_edges, entry * 3u + side), k, origin, params);
}

/// The item of a discontinuity of gvs++. border: the ray that met it; number: its running number in the cell.
SL_FUNC ReverseItem reverseItemPast(SL_STAGE_PARAM, Ray border, uint occluder, uint64 number) {
  vec3 target = add3(xyz3(border.origin), xyz3(border.direction));
  uint mask = 0u;
  for (uint f = 0u; f < SL_LAUNCH(params).counts.w; ++f) {
    mask |= (faceLooksAt(SL_BUFFER(faces, f), target) ? 1u : 0u) << f;
  }
  ReverseItem item = openItem(target, number, mask);
  if (occluder == kNoTriangle) return item;
  Corners corners = SL_CORNERS(occluder);
  return occludedItem(item, corners.a, corners.b, corners.c);
}

/// The item of the discontinuity at `place` of those that wait, by the method of the parameters.
SL_FUNC ReverseItem reverseItemAt(SL_STAGE_PARAM, uint place) {
  StageParams params = SL_LAUNCH(params);
  uvec4 ray = SL_BUFFER(discontinuities, place).ray;
  PvsEntry entry = SL_BUFFER(entries, ray.x);
  Corners t = SL_CORNERS(entry.origin_triangle.w);
  Ray border = polygonRay(t.a, t.b, t.c, ray.y, ray.w, vectorOfBits(entry.origin_triangle), params);
  ReverseItem item = reverseItemPast(SL_STAGE, border, ray.z, SL_LAUNCH(items_before) + place);
  if (!isGvs(params)) return item;
  return gvsReverseItem(item, entryRay(entry), t.a, t.b, t.c, params);
}

/// Reverse ray k of an item; without direction where no face looks at it, or its start point sees nothing but
/// the occluder, or, in the original method, lies outside the cell, or the cell does not look.
SL_FUNC Ray reverseRayOf(SL_STAGE_PARAM, ReverseItem item, uint k) {
  StageParams params = SL_LAUNCH(params);
  if (item.number.z == 0u) return noRay();
  if (!isGvs(params)) return reverseRay(item, SL_BUFFER(faces, reverseFace(item, k)), k, params);
  Ray ray = noRay();
  for (uint f = 0u; f < params.counts.w && !hasDirection(ray); ++f) {
    ray = gvsReverseRay(item, SL_BUFFER(faces, f), k, params);
  }
  return ray;
}

/// Reverse ray `index` (0 ..) of the reverse launch, or none.
SL_FUNC Ray reverseRayAt(SL_STAGE_PARAM, uint index) {
  uint per_item = reverseRayCount(SL_LAUNCH(params));
  uint place = index / per_item;
  return reverseRayOf(SL_STAGE, SL_BUFFER(reverse_items, place), index - place * per_item);
}

/// The random ray with this index (1 ..) in the batch.
SL_FUNC Ray segmentRayAt(SL_STAGE_PARAM, uint index) {
  for (uint s = 0u; s < SL_LAUNCH(segment_count); ++s) {
    RandomSegment segment = SL_BUFFER(segments, s);
    uint offset = index - segment.batch.x;
    if (offset < segment.range.w) {
      return randomRay(segmentFirst(segment), offset, SL_BUFFER(faces, segment.range.x),
                       SL_LAUNCH(params).shifts);
    }
  }
  return noRay();
}

SL_NAMESPACE_END

// Which instance a triangle belongs to. The file that includes this defines SL_INSTANCES_PARAM, what holds the
// instances, and SL_INSTANCE_IDS(k): InstanceRecord::ids of the instance k, in the order of ids.
SL_NAMESPACE_BEGIN

/// count: of instances.
SL_FUNC StoredTriangle findTriangle(SL_INSTANCES_PARAM, uint count, uint id) {
  uint low = 0u;  // the instances below low begin at or before id, those from high on after it
  uint high = count;
  while (low < high) {
    uint middle = low + (high - low) / 2u;
    if (SL_INSTANCE_IDS(middle).x <= id) {
      low = middle + 1u;
    } else {
      high = middle;
    }
  }
  StoredTriangle result;
  result.triangle = id;
  result.instance = kNoTriangle;
  if (low == 0u) return result;
  uvec4 ids = SL_INSTANCE_IDS(low - 1u);
  uint offset = id - ids.x;
  if (offset < ids.y) {
    result.triangle = ids.w + offset;
    result.instance = low - 1u;
  } else {
    result.triangle = ids.z + (offset - ids.y);
  }
  return result;
}

SL_NAMESPACE_END

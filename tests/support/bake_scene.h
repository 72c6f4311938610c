#pragma once
#include <memory>
#include <string>

#include "core/device/registry/make_device.h"
#include "core/gvs/bake_cell.h"
#include "core/scene/scene_tree.h"

namespace sightline::testing_support {

/// Parameters small enough for tests.
inline BakeParams quickParams() {
  BakeParams params;
  params.n_rand = 200'000;
  params.validation_rays = 100'000;
  return params;
}

/// Bakes one cell on a device made for it.
inline CellPvs bakeOn(const std::string& device, const Scene& scene, const ViewCell& cell,
                      const BakeParams& params = quickParams(), const DeviceOptions& options = {},
                      const BvhConfig& tree = {}) {
  const Bvh bvh = buildSceneTree(scene, tree);
  return bakeCell(*makeDevice(device, scene, bvh, options), scene, cell, 0, params);
}

/// Ids first .. first + count - 1.
inline std::vector<uint32_t> idRange(uint32_t first, uint32_t count) {
  std::vector<uint32_t> ids;
  for (uint32_t i = 0; i < count; ++i) ids.push_back(first + i);
  return ids;
}

}  // namespace sightline::testing_support

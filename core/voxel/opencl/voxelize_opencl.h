#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "core/voxel/voxelize.h"

namespace sightline {

/// How a device voxelises. No bit of the result depends on it.
struct OpenClVoxelizing {
  size_t blocks_a_time = 2048;  ///< work groups of a launch
  uint32_t group = 0;           ///< work items a block, at most 256; 0: 64
  bool floats = false;          ///< decide in single precision also where the device has double
  uint32_t bricks = 1 << 17;    ///< room in lists at first: they grow when they are too short
  uint32_t open_rows = 1 << 14;
};

/// What a device did.
struct OpenClVoxelized {
  uint64_t pairs = 0;           ///< of a triangle and a block
  uint64_t open_rows = 0;       ///< of them, decided on the host
  uint64_t open_pairs = 0;      ///< likewise, all their rows
  uint64_t open_triangles = 0;  ///< of all, whose blocks were found on the host
  uint64_t repeats = 0;         ///< launches that were done again with longer lists
  double setup_seconds = 0;     ///< to find and compile for the device, and to upload the scene
  double bin_seconds = 0;       ///< to find which triangles meet which blocks
  double device_seconds = 0;    ///< of its work, and to and from it
  double host_seconds = 0;      ///< to collect bricks, and to decide what was open
};

/// voxelize on an OpenCL device (selector as OpenClContext's), with the same bytes as on the processor: the
/// device sets what arithmetic with a bound on its error decides, in double where it has it, and lists the
/// rows that are left for TriangleRows or SeparatingRows. So it bins triangles, too. Attributes are made on
/// the host. The scene must fit into the device's memory. Throws as voxelize and OpenClContext.
OpenClVoxelized voxelizeOpenCl(const Scene& scene, const VoxelizeOptions& options, const std::string& device,
                               const std::function<void(VoxelBlock&&)>& take,
                               const OpenClVoxelizing& tuning = {});

}  // namespace sightline

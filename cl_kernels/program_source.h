#pragma once

namespace sightline {

/// OpenCL C source of all kernels of bakes, with core/shared included; embedded at build time.
extern const char* const kProgramSource;

/// Likewise that of the voxeliser's (cl_kernels/voxelize.cl).
extern const char* const kVoxelizeSource;

}  // namespace sightline

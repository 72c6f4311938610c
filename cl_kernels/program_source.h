#pragma once

namespace sightline {

/// OpenCL C source of all kernels, with core/shared included; embedded at build time.
extern const char* const kProgramSource;

}  // namespace sightline

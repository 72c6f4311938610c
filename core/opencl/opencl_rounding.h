#pragma once
// Whether a device divides and takes roots correctly rounded, found out by trying.
#include "core/opencl/opencl_context.h"

namespace sightline {

/// Compiles a kernel of these two expressions of the floats a and b as this program's kernels are compiled,
/// and runs it on 65,536 pairs, most of them hard: with quotients and roots as close to the middle of two
/// floats as there are, or below 2^-126. Returns whether all results are the host's, bit for bit. Throws
/// Error.
bool roundsCorrectly(cl_device_id device, const char* quotient = "a / b", const char* root = "sqrt(a)");

}  // namespace sightline

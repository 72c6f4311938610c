#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace sightline {

/// SPIR-V of a shader, compiled and embedded at build time, with every float operation NoContraction: the
/// driver may not fuse a * b + c. Names: "nearest.rchit", "count_bits.comp"; the tracing stages exist for ray
/// tracing pipelines ("trace_random.rgen") and with ray queries ("trace_random.comp"), for scenes with holes or sides
/// as "trace_random.surfaces.rgen", with glass as "trace_random.glass.rgen", and so on.
/// Throws std::out_of_range for an unknown name.
std::span<const uint32_t> shaderCode(std::string_view name);

}  // namespace sightline

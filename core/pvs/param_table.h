#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <variant>

#include "core/pvs/bake_params.h"

// What there is to say about each field of BakeParams, in one place: .pvs file, differences, JSON, page,
// info, checks and options of the command line follow from it, and docs/parameters.md is tested against it. A
// new parameter is a field of BakeParams and a line at the end of kParams.
namespace sightline {

/// A field and the values that it may have, `low` to `high`.
template <typename Value>
struct ParamField {
  Value BakeParams::*member;
  Value low, high;
};

using AnyParamField = std::variant<ParamField<uint32_t>, ParamField<uint64_t>, ParamField<float>,
                                   ParamField<double>, ParamField<Method>, ParamField<Order>>;

/// Parameters that pages and `info` show together, in this order.
enum class ParamGroup {
  kMethod,
  kSeed,
  kSamples,
  kThinning,
  kDistances,
  kStopRule,
  kBatch,
  kValidation,
  kHoles
};
inline constexpr ParamGroup kParamGroups[] = {
    ParamGroup::kMethod,   ParamGroup::kSeed,       ParamGroup::kSamples,
    ParamGroup::kThinning, ParamGroup::kDistances,  ParamGroup::kStopRule,
    ParamGroup::kBatch,    ParamGroup::kValidation, ParamGroup::kHoles};
/// "method", "seed", "samples", ...
std::string paramGroupName(ParamGroup group);

/// Sets of methods: bit i is that of Method(i).
inline constexpr uint32_t methodBit(Method method) {
  return 1u << uint32_t(method);
}
inline constexpr uint32_t kEveryMethod = ~0u;
inline constexpr uint32_t kMethodsByRays = kEveryMethod & ~methodBit(Method::kRaster);
inline constexpr uint32_t kMethodsThatExplore =
    methodBit(Method::kGvspp) | methodBit(Method::kGvs) | methodBit(Method::kNaive);
/// gvs has fixed samples.
inline constexpr uint32_t kMethodsThatSample = methodBit(Method::kGvspp) | methodBit(Method::kNaive);

struct Param {
  AnyParamField field;
  const char* name;  ///< in JSON, differences, `info`; with - for _ the option of `sightline bake`
  const char* unit;  ///< of the value; empty: a name or a plain number
  const char* off;   ///< what 0 means where it switches something off, "none"; else null. Such a 0 is good
                     ///< even below the range.
  uint32_t since;    ///< first version of the format that holds it; of older files it has its default
  uint32_t methods;  ///< that use it
  ParamGroup group;
  const char* label;  ///< for people, on pages
  const char* help;   ///< of the option
};

namespace param_table {

inline constexpr uint32_t kMostUint32 = std::numeric_limits<uint32_t>::max();
inline constexpr uint64_t kMostUint64 = std::numeric_limits<uint64_t>::max();
inline constexpr float kMostFloat = std::numeric_limits<float>::max();
/// What people would wait for, and what still is exact in the doubles of an estimate.
inline constexpr uint64_t kMostRays = 1'000'000'000'000'000'000, kMostValidationRays = 1'000'000'000'000'000;

}  // namespace param_table

/// In the order of the HEAD section, which can only grow at its end.
inline constexpr Param kParams[] = {
    {ParamField<Method>{&BakeParams::method, Method::kGvspp, Method::kBound}, "method", "", nullptr, 3,
     kEveryMethod, ParamGroup::kMethod, "method",
     "gvs++; gvs: the original, with fewer border and reverse rays; random: random rays alone; raster: "
     "drawn hemicubes, on vulkan only; naive: gvs++ with the set on the host, for comparison; bound: not of "
     "bakes but of sightline bound"},
    {ParamField<uint32_t>{&BakeParams::n_rand, 1, param_table::kMostUint32 - 2}, "n_rand", "rays", nullptr, 3,
     kEveryMethod, ParamGroup::kSamples, "random rays an iteration", "random rays an iteration"},
    {ParamField<uint32_t>{&BakeParams::n_abs_edge, 0, 1000}, "n_abs_edge", "samples", nullptr, 3,
     kMethodsThatSample, ParamGroup::kSamples, "border samples an edge",
     "samples along each long edge of the border polygon at most"},
    {ParamField<uint32_t>{&BakeParams::n_rs_edge, 0, 1000}, "n_rs_edge", "samples", nullptr, 3,
     kMethodsThatSample, ParamGroup::kSamples, "reverse samples an edge",
     "reverse samples along each edge of the cell's faces"},
    {ParamField<uint32_t>{&BakeParams::n_rs_area, 0, 100'000}, "n_rs_area", "samples", nullptr, 3,
     kMethodsThatSample, ParamGroup::kSamples, "reverse samples on faces",
     "reverse samples on the cell's faces"},
    {ParamField<float>{&BakeParams::delta_abs_relative, 0, param_table::kMostFloat}, "delta_abs_relative",
     "of the distance", nullptr, 3, kMethodsThatExplore, ParamGroup::kDistances,
     "border distance, share of the distance", "border distance as a share of the distance"},
    {ParamField<float>{&BakeParams::delta_abs, 0, param_table::kMostFloat}, "delta_abs", "world units",
     nullptr, 3, kMethodsThatExplore, ParamGroup::kDistances, "border distance added, world units",
     "border distance in world units (thesis: 0.001), added to the relative one"},
    {ParamField<float>{&BakeParams::delta_rs_relative, 0, param_table::kMostFloat}, "delta_rs_relative",
     "of the distance", nullptr, 3, kMethodsThatExplore, ParamGroup::kDistances,
     "discontinuity, share of the distance", "discontinuity threshold as a share of the distance"},
    {ParamField<float>{&BakeParams::delta_rs, 0, param_table::kMostFloat}, "delta_rs", "world units", nullptr,
     3, kMethodsThatExplore, ParamGroup::kDistances, "discontinuity added, world units",
     "discontinuity threshold in world units, added to the relative one"},
    {ParamField<uint32_t>{&BakeParams::threshold, 0, param_table::kMostUint32}, "threshold", "triangles",
     nullptr, 3, kEveryMethod, ParamGroup::kStopRule, "T", "T: a quiet iteration finds fewer new triangles"},
    {ParamField<uint32_t>{&BakeParams::quiet_iterations, 1, 1'000'000}, "quiet_iterations", "iterations",
     nullptr, 3, kEveryMethod, ParamGroup::kStopRule, "quiet iterations",
     "stop after so many quiet iterations in a row"},
    {ParamField<uint32_t>{&BakeParams::batch_rays, kFewestBatchRays, 1u << 28}, "batch_rays", "rays", nullptr,
     3, kMethodsThatExplore, ParamGroup::kBatch, "rays of a batch",
     "rays of a border or reverse batch at most"},
    {ParamField<uint64_t>{&BakeParams::max_rays, 0, param_table::kMostRays}, "max_rays", "rays", "none", 3,
     kEveryMethod, ParamGroup::kStopRule, "most rays a cell", "stop a cell after so many rays (0: no limit)"},
    {ParamField<uint64_t>{&BakeParams::validation_rays, 0, param_table::kMostValidationRays},
     "validation_rays", "rays", nullptr, 3, kEveryMethod, ParamGroup::kValidation, "validation rays",
     "rays that measure what a cell missed"},
    {ParamField<uint64_t>{&BakeParams::seed, 0, param_table::kMostUint64}, "seed", "", nullptr, 3,
     kEveryMethod, ParamGroup::kSeed, "seed", "seed of the random rays, 0 to 2^64 - 1"},
    {ParamField<double>{&BakeParams::max_seconds, 0, param_table::kMostFloat}, "max_seconds", "seconds",
     "none", 3, kEveryMethod, ParamGroup::kStopRule, "most seconds a cell",
     "stop a cell after so many seconds (0: no limit)"},
    {ParamField<uint32_t>{&BakeParams::raster_resolution, 16, 16384}, "raster_resolution", "pixels", nullptr,
     3, methodBit(Method::kRaster), ParamGroup::kSamples, "pixels a side",
     "raster: pixels along an edge of a hemicube's front"},
    {ParamField<double>{&BakeParams::target_error, kSmallestTargetError, 0.999999}, "target_error",
     "of the pixels", "none", 3, kEveryMethod, ParamGroup::kStopRule, "target error",
     "stop a cell when the share of wrong pixels is below E with 95 % confidence, instead of by "
     "--threshold (docs/evaluation.md)"},
    {ParamField<float>{&BakeParams::abs_spacing, 0, param_table::kMostFloat}, "abs_spacing", "radians",
     "none", 3, kMethodsThatSample, ParamGroup::kThinning, "their spacing, in radians",
     "fewer border samples where they come closer to each other, in radians seen from the ray's origin "
     "(0: never)"},
    {ParamField<uint32_t>{&BakeParams::reverse_stride, 1, param_table::kMostUint32}, "reverse_stride",
     "samples", nullptr, 3, kMethodsThatSample, ParamGroup::kThinning, "reverse stride",
     "of neighbouring border samples with the same occluder, reverse samples for the first and every "
     "N-th (1: for all)"},
    {ParamField<Order>{&BakeParams::order, Order::kQueue, Order::kYield}, "order", "", nullptr, 3,
     kMethodsThatSample, ParamGroup::kThinning, "order",
     "yield: the kind of ray that finds most goes first; queue: reverse rays of a batch follow its "
     "border rays, as in the thesis"},
    {ParamField<float>{&BakeParams::smallest_hole, 0, param_table::kMostFloat}, "smallest_hole",
     "world units", "none", 5, kMethodsByRays, ParamGroup::kHoles, "smallest hole",
     "gaps narrower than this count as closed, those wider than twice as much as open (0: every gap is "
     "open; docs/doors-and-gaps.md)"},
    {ParamField<float>{&BakeParams::bound, 0, param_table::kMostFloat}, "bound", "world units", "none", 6,
     kEveryMethod, ParamGroup::kHoles, "voxels of the bound",
     "a .pvs file of sightline bound: what it proves hidden is left out of the sets; kept is the side of "
     "its voxels (docs/bounds.md)"},
};

/// Calls f(const Param&, value) for each, in the order of kParams. Params: BakeParams, perhaps const.
template <typename Params, typename F>
void visitParams(Params& params, F&& f) {
  for (const Param& param : kParams) {
    std::visit([&](const auto& field) { f(param, params.*field.member); }, param.field);
  }
}

/// The line of that name, which must be there: another name does not compile.
consteval const Param& paramOf(std::string_view name) {
  for (const Param& param : kParams) {
    if (param.name == name) return param;
  }
  throw "no such parameter";
}

inline bool isUsedBy(const Param& param, Method method) {
  return (param.methods & methodBit(method)) != 0;
}

/// "--n-rand".
std::string optionOf(const Param& param);
/// The values that it may have: "1 .. 4294967293", "at least 1", "finite and not negative", "0 (off) or 1e-10
/// .. 0.999999", or the names.
std::string rangeText(const Param& param);
/// Its value as the command line takes it: a whole number, a shortest decimal number, a name.
std::string valueText(const Param& param, const BakeParams& params);

/// The same for people: "none" where 0 switches it off.
std::string shownText(const Param& param, const BakeParams& params);

/// Whether both have the same value of it.
bool sameValue(const Param& param, const BakeParams& a, const BakeParams& b);

/// In one line, starting with the option without its dashes, which parameter is out of its range; empty:
/// none.
std::string paramProblem(const BakeParams& params);

}  // namespace sightline

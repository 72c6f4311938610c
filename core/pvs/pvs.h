#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/cell/view_cell.h"
#include "core/pvs/method.h"
#include "core/pvs/order.h"
#include "core/shared/types.h"

namespace sightline {

/// Parameters of a bake that decide its result (thesis 6.2.2, with its names). Same scene, cells, seed and
/// parameters: same sets, bit for bit.
struct BakeParams {
  Method method = Method::kGvspp;
  uint32_t n_rand = 10'000'000;  ///< random rays an iteration, 1 .. 2^32 - 3
  uint32_t n_abs_edge = 30;      ///< samples along each long edge of the border polygon, 0..1000: at most,
  float abs_spacing = 0x1p-11f;  ///< where they come closer than this to each other, seen from the ray's
                                 ///< origin in radians (0: never fewer)
  uint32_t n_rs_edge = 3;        ///< samples along each edge of the view cell's faces, 0..1000
  uint32_t n_rs_area = 4;        ///< samples on the view cell's faces, 0..100000
  uint32_t reverse_stride = 4;   ///< reverse samples for the first of neighbouring border samples with the
                                 ///< same occluder, and every so many-th; 1: for all
  Order order = Order::kYield;   ///< of gvs++ and naive
  float delta_abs_relative = 0x1p-17f;  ///< border distance, share of the distance from the ray's origin
  float delta_abs = 0;                  ///< border distance in world units (thesis: 0.001), added
  float delta_rs_relative = 0x1p-10f;   ///< discontinuity threshold, share of the distance
  float delta_rs = 0;                   ///< discontinuity threshold in world units, added
  uint32_t threshold = 10;              ///< T: stop after fewer new triangles in an iteration ...
  uint32_t quiet_iterations = 1;        ///< ... in this many iterations one after the other
  uint64_t max_rays = 0;                ///< stop a cell after so many rays (0: no limit)
  double max_seconds = 0;          ///< stop a cell after so many seconds (0: no limit; not deterministic)
  uint32_t batch_rays = 1u << 24;  ///< rays of a border or reverse batch at most, 4096 or more; nor has a
                                   ///< batch more than the cell traced before it
  uint64_t validation_rays = 10'000'000;  ///< fresh random rays after each cell that measure the miss rate
  uint64_t seed = 1;
  uint32_t raster_resolution = 1000;  ///< method raster only: pixels along an edge of a hemicube's front side
  double target_error = 0;  ///< stop a cell at this share of wrong pixels (95 % upper bound), in place of the
                            ///< threshold; 0: off, else kSmallestTargetError up to 1
  bool operator==(const BakeParams&) const = default;
};

inline constexpr double kSmallestTargetError = 1e-10;
inline constexpr uint32_t kFewestBatchRays = 4096;

/// Counts of one stage of one cell.
struct StageStats {
  uint64_t rays = 0;           ///< traced
  uint64_t new_triangles = 0;  ///< that this stage found
  double seconds = 0;
};

/// Why a cell's bake ended.
enum class StopReason : uint32_t { kConverged = 0, kRayLimit = 1, kTimeLimit = 2, kTargetError = 3 };

/// What a cell's bake did.
struct CellStats {
  StageStats random, border, reverse;
  uint64_t contained_triangles = 0;  ///< in the set only because they meet the cell itself
  uint32_t iterations = 0;
  StopReason stop = StopReason::kConverged;
  uint64_t validation_rays = 0;  ///< fresh random rays
  uint64_t missing_rays = 0;     ///< of them: hit a triangle outside the set
  uint64_t bound_rays = 0;       ///< fresh rays of random pixels that tested the error (target_error)
  uint32_t bound_tests = 0;      ///< in so many tests
  double error_bound = 1;        ///< upper bound of the share of wrong pixels, 95 % confidence; 1: not tested
  double seconds = 0;            ///< whole cell, validation included
  uint64_t peak_device_bytes = 0;
};

/// Upper end of the two-sided 95 % interval (Clopper and Pearson 1934) of the share missing / rays, 0..1.
/// rays = 0 gives 1.
double missingUpperBound(uint64_t missing, uint64_t rays);

/// Upper end of the one-sided interval that may be wrong with probability `tail`, above 0 and below 0.5.
double missingUpperBound(uint64_t missing, uint64_t rays, double tail);

/// The fewest rays of which `missing` may miss for that bound to be below `share`, above 0 and below 1.
uint64_t raysForBound(uint64_t missing, double share, double tail);

/// A ray that hits its triangle first.
struct Witness {
  glm::vec3 origin{0}, direction{0};
  uint32_t stage = kStageRandom;  ///< kStage...; of a contained triangle origin and direction are 0
};

/// The potentially visible set of one cell.
struct CellPvs {
  ViewCell cell;
  CellStats stats;
  std::string device;               ///< DeviceInfo::id and name of the device that baked it
  std::vector<uint32_t> triangles;  ///< ids, ascending, unique
  std::vector<Witness> witnesses;   ///< one a triangle, or empty
};

/// Version of the format that this program writes.
inline constexpr uint32_t kPvsVersion = 4;

/// All of a .pvs file (docs/pvs-format.md).
struct PvsFile {
  uint32_t version = kPvsVersion;  ///< of the format that it was read from
  uint32_t algorithm = 0;   ///< kAlgorithmRevision (core/gvs/algorithm_revision.h) of the program that baked;
                            ///< 1 for all that wrote older versions of the format
  std::string intersector;  ///< intersectorOf the device (core/trace/device_info.h): the sets depend on it
  uint64_t scene_hash = 0;
  uint32_t triangle_count = 0;  ///< of the scene
  std::string scene_name;       ///< file name without folder, for people
  std::string device;           ///< on which the bake began: that of the first cell; empty before it
  BakeParams params;
  bool has_witnesses = false;     ///< every cell has one witness a triangle
  std::vector<ViewCell> planned;  ///< all cells of the bake, in order; cells holds the first of them
  std::vector<CellPvs> cells;     ///< baked so far; complete when as many as planned
};

/// What is in a file is no bake that this program can use: another kind of file, another version of the
/// format, or damaged. Baking again helps; reading again does not.
class BadPvs : public Error {
 public:
  using Error::Error;
};

/// Reads and checks everything: magic, version, sizes, checksums, cells, ids in range and ascending. Throws
/// BadPvs (file, offset, what was expected), or Error if the file cannot be read.
PvsFile loadPvs(const std::filesystem::path& file);

/// Writes to a temporary name beside it, flushes to disk and renames; each pvs.cells with its device. In
/// pvs.version's stead it writes kPvsVersion. Throws Error.
void savePvs(const PvsFile& pvs, const std::filesystem::path& file);

}  // namespace sightline

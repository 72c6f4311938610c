#pragma once
#include <array>
#include <string>
#include <vector>

#include "core/bake/cell_json.h"
#include "core/crosscheck/difference.h"
#include "core/device/device.h"
#include "core/gvs/bake_cell.h"
#include "core/pvs/bake_params.h"
#include "core/pvs/cell_pvs.h"
#include "core/scene/scene.h"
#include "core/verify/cell_sight.h"

namespace sightline {

/// A triangle that one device's bake found and the other's did not, and whose witness they answer
/// differently.
struct DisputedTriangle {
  uint32_t triangle = 0;
  uint32_t found_by = 0;  ///< 0: the first device, 1: the other
  Witness witness;
  std::array<Hit, 2> hits{};        ///< of the witness, by device
  std::array<Ruling, 2> rulings{};  ///< on these
};

/// A triangle of a device's set that the cell's definition rules out, whatever the devices answer.
struct FaultyTriangle {
  uint32_t triangle = 0;
  uint32_t found_by = 0;  ///< 0: the first device, 1: the other
  Fault fault = Fault::kNone;
  Witness witness;
};

/// How the sets of one cell, baked on two devices, differ. Every triangle of the difference is explained: the
/// other device answers its witness in the same way, and only happened to trace other rays; or it is
/// disputed, and the judge decided.
struct PvsDifference {
  std::string cell;
  std::array<uint64_t, 2> sizes{};       ///< of the sets
  std::array<uint64_t, 2> only{};        ///< triangles that only this device's set has
  std::array<uint64_t, 2> other_rays{};  ///< of them: the other device's rays did not come there
  std::vector<DisputedTriangle> disputed;
  std::vector<FaultyTriangle> faulty;  ///< of both sets, whether they differ there or not

  /// Triangles of a device's set that the cell's definition rules out.
  uint64_t faults(size_t device) const;
  /// Disputed triangles on whose witness the judge finds this of a device's answer.
  uint64_t count(size_t device, Verdict verdict) const;
};

/// Bakes the cell on both devices, which hold `scene`, and explains the difference. hooks: of both bakes.
/// Throws Error, Interrupted.
PvsDifference comparePvs(const Judge& judge, const Scene& scene, const ViewCell& cell, uint32_t cell_index,
                         Device& first, Device& other, const BakeParams& params,
                         const RoundingLimit& limit = {}, const BakeHooks& hooks = {});

/// A line a cell for the pair.
std::string pvsDifferenceTable(const std::string& first, const std::string& other,
                               const std::vector<PvsDifference>& cells);
/// As docs/report.md says.
Json pvsDifferenceJson(const std::string& first, const std::string& other,
                       const std::vector<PvsDifference>& cells);

}  // namespace sightline

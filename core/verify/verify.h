#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/bake/cell_json.h"
#include "core/judge/ruling.h"
#include "core/pvs/pvs_file.h"
#include "core/scene/scene.h"
#include "core/verify/cell_sight.h"

namespace sightline {

/// What the judge finds of a triangle of a set.
enum class Proof : uint8_t {
  kProven,     ///< its witness, as it is, meets it first
  kImproved,   ///< its witness does so up to rounding only, but another ray from the cell does exactly
  kPoint,      ///< so does a ray to a point of its border, exactly, though no ray of floats was found
  kContained,  ///< it has no witness: it meets the cell itself
  kRounded,    ///< its witness does so up to rounding only, and no better one was found
  kDisproved,  ///< something is wrong with it: see Fault
};
inline constexpr uint32_t kProofs = 6;
/// "proven", "improved", "point", "contained", "rounded", "disproved".
std::string proofName(Proof proof);

/// A triangle without a ray of floats that proves it.
struct OpenProof {
  uint32_t triangle = 0;
  Proof proof = Proof::kRounded;  ///< kPoint, kRounded or kDisproved
  Fault fault = Fault::kNone;     ///< of kDisproved
  Witness witness;                ///< as it was; kPoint: from where the target is seen
  double steps_beside = 0;        ///< as of Ruling
  glm::dvec3 target{0.0};         ///< kPoint: what is seen of the triangle
};

struct CellProofs {
  std::string cell;
  std::array<uint64_t, kProofs> counts{};
  std::array<uint64_t, kFaults> faults{};  ///< of the disproved triangles
  std::vector<OpenProof> open;             ///< by triangle

  /// Proven, improved or proven by a point, of all that have a witness or are disproved; 1 where there are
  /// none.
  double provenShare() const;
};

struct VerifyOptions {
  RoundingLimit rounding;
  /// Places of the cell that are tried for a better witness, at most.
  uint32_t tries = 5000;
};

/// Judges every triangle of a cell's set, by the definition of the cell and by its witness, and puts better
/// witnesses in the place of others where there are (their stage stays). Deterministic. The cell must have
/// witnesses.
CellProofs verifyCell(const Judge& judge, const Scene& scene, CellPvs& pvs,
                      const VerifyOptions& options = {});

/// Takes the triangles that were disproved out of the set that verifyCell judged.
void removeDisproved(const CellProofs& proofs, CellPvs& pvs);

/// A line a cell, and the first open proofs.
std::string verifyTable(const std::vector<CellProofs>& cells);
/// As docs/report.md says: the part on the cells.
Json verifyJson(const std::vector<CellProofs>& cells);

}  // namespace sightline

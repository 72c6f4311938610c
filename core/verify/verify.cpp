#include "core/verify/verify.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/judge/seen_triangle.h"
#include "core/sampling/ray_random.h"
#include "core/scene/contained.h"

namespace sightline {
namespace {

/// Steps from the border of a triangle to its middle that a better ray is aimed at, each half of the next.
constexpr int kInwardSteps = 20;
/// Places of an edge that are tried are multiples of its share: few digits keep them exact.
constexpr double kEdgePlaces = 1 << 16;
/// Rays from the witness's own place that are aimed at random, before others.
constexpr uint32_t kTriesFromSamePlace = 40;
/// Binary digits of places below the cell's size, and how many more.
constexpr int kFewestDigits = 3, kDigitChoices = 6;

Ray rayOf(const Witness& witness) {
  return {vec4(witness.origin, 0), vec4(witness.direction, 0)};
}

/// A ray that meets a triangle first.
struct Better {
  Witness witness;
  bool floats = true;      ///< the witness is that ray
  glm::dvec3 target{0.0};  ///< else it runs from the witness's origin to here
};

/// Searches for a ray from a cell that meets a triangle first.
///
/// What a rounded ray found is often seen by its border alone: a triangle that faces away, beyond an edge
/// which it shares with one that is seen. Then only rays that pass exactly through that edge prove it. So
/// rays are aimed at corners and middles of edges too, from places with few digits, so that the difference of
/// target and origin is a float, exactly.
class BetterWitness {
 public:
  BetterWitness(const Judge& judge, const CellSight& sight, uint32_t triangle, const Witness& witness,
                const VerifyOptions& options)
      : judge_(judge),
        sight_(sight),
        triangle_(triangle),
        shape_(judge.corners(triangle)),
        witness_(witness),
        options_(options) {}

  std::optional<Better> find() {
    if (auto found = search()) return Better{*found};
    return point_;
  }

 private:
  std::optional<Witness> search() {
    if (auto found = inwards()) return found;
    if (auto found = atBorder(witness_.origin)) return found;
    RayRandom random(0, triangle_);
    for (uint32_t i = 0; i < options_.tries; ++i) {
      const glm::vec3 origin = i < kTriesFromSamePlace ? witness_.origin : anyPlace(random, i);
      if (!sight_.beginsOnCell(glm::dvec3(origin))) continue;
      if (auto found = attempt(origin, anyTarget(random))) return found;
      if (i < kTriesFromSamePlace) continue;
      if (auto found = atBorder(origin)) return found;
    }
    return std::nullopt;
  }

  /// From where the witness passes the triangle's border towards its middle.
  std::optional<Witness> inwards() {
    const JudgeRay ray = judgeRay(rayOf(witness_));
    const SeenTriangle seen(shape_, ray, RayFrame(ray.direction));
    const glm::dvec3 corners[] = {shape_.a, shape_.b, shape_.c};
    int nearest = 0;
    double nearest_along = 0;
    for (int i = 0; i < 3; ++i) {
      const glm::dvec2 p = seen.corners[i], q = seen.corners[(i + 1) % 3];
      const double length = glm::length(q - p);
      const double along = length == 0 ? 0 : std::min(1.0, glm::length(seen.nearest_of_edge[i] - p) / length);
      border_.push_back(onEdge(i, 0));
      border_.push_back(onEdge(i, 0.5));
      border_.push_back(onEdge(i, std::round(along * kEdgePlaces) / kEdgePlaces));
      if (glm::length(seen.nearest_of_edge[i]) > glm::length(seen.nearest_of_edge[nearest])) continue;
      nearest = i;
      nearest_along = along;
    }
    const glm::dvec3 border = glm::mix(corners[nearest], corners[(nearest + 1) % 3], nearest_along);
    const glm::dvec3 middle = (shape_.a + shape_.b + shape_.c) / 3.0;
    for (int step = kInwardSteps; step >= 0; --step) {
      if (auto found = attempt(witness_.origin, glm::mix(border, middle, std::exp2(-step)))) return found;
    }
    return std::nullopt;
  }

  /// A point of an edge, exactly where `along` has few digits.
  glm::dvec3 onEdge(int edge, double along) const {
    const glm::dvec3 corners[] = {shape_.a, shape_.b, shape_.c};
    return corners[edge] + (corners[(edge + 1) % 3] - corners[edge]) * along;
  }

  /// At corners, middles of edges, and where the witness passed them.
  std::optional<Witness> atBorder(const glm::vec3& origin) {
    for (const glm::dvec3& target : border_) {
      if (auto found = attempt(origin, target)) return found;
      if (!point_) attemptExactly(origin, target);
    }
    return std::nullopt;
  }

  /// By the ray from the origin to the target itself; their difference must be exact in double.
  void attemptExactly(const glm::vec3& origin, const glm::dvec3& target) {
    const glm::dvec3 from(origin), direction = target - from;
    if (from + direction != target || target - direction != from || direction == glm::dvec3(0.0)) return;
    if (!sight_.looksAlong(direction)) return;
    if (!judge_.sees({from, direction}, triangle_)) return;
    point_ = Better{{origin, glm::vec3(direction), witness_.stage}, false, target};
  }

  glm::dvec3 anyTarget(RayRandom& random) const {
    const double u = random.unit(), v = random.unit();
    const double a = u + v > 1 ? 1 - u : u, b = u + v > 1 ? 1 - v : v;
    return shape_.a * (1 - a - b) + shape_.b * a + shape_.c * b;
  }

  /// A place in the cell with few digits, the more the later.
  glm::vec3 anyPlace(RayRandom& random, uint32_t i) const {
    const glm::dvec3 place = sight_.frame().toWorld(sight_.frame().half_size * glm::dvec3(random.point()));
    const double largest = maxAbs(sight_.frame().half_size);
    const double grid = std::exp2(std::floor(std::log2(largest)) - kFewestDigits - i % kDigitChoices);
    glm::dvec3 rounded = glm::round(place / grid) * grid;
    for (int axis = 0; axis < 3; ++axis) {  // a flat cell's own plane must not be left
      if (!sight_.beginsOnCell(glm::dvec3(glm::vec3(rounded)))) rounded[axis] = place[axis];
    }
    return glm::vec3(rounded);
  }

  std::optional<Witness> attempt(const glm::vec3& origin, const glm::dvec3& target) const {
    const Witness better{origin, glm::vec3(target - glm::dvec3(origin)), witness_.stage};
    const glm::dvec3 direction(better.direction);
    if (direction == glm::dvec3(0.0) || !sight_.looksAlong(direction)) return std::nullopt;
    if (!judge_.sees(judgeRay(rayOf(better)), triangle_)) return std::nullopt;
    return better;
  }

  const Judge& judge_;
  const CellSight& sight_;
  uint32_t triangle_;
  JudgeTriangle shape_;
  const Witness& witness_;
  const VerifyOptions& options_;
  std::vector<glm::dvec3> border_;  ///< points of the border
  std::optional<Better> point_;
};

/// Judges one witness that the cell's definition allows, and replaces it by a better one.
OpenProof judgeWitness(const Judge& judge, const CellSight& sight, uint32_t triangle, Witness& witness,
                       const VerifyOptions& options) {
  OpenProof result{triangle, Proof::kDisproved, Fault::kNotMet, witness, 0, {}};
  const Ray ray = rayOf(witness);
  const ExactHit exact = judge.nearest(judgeRay(ray));
  if (exact.contains(triangle) || (judge.isGlass(triangle) && judge.sees(judgeRay(ray), triangle))) {
    result.proof = Proof::kProven;
    result.fault = Fault::kNone;
    return result;
  }

  // The witness says which triangle, not where.
  const Ruling ruling = rule(judge, ray, {0, triangle}, exact, options.rounding, false);
  result.steps_beside = ruling.steps_beside;
  if (ruling.verdict != Verdict::kRounded) return result;
  result.fault = Fault::kNone;
  const auto better = BetterWitness(judge, sight, triangle, witness, options).find();
  result.proof = !better ? Proof::kRounded : (better->floats ? Proof::kImproved : Proof::kPoint);
  if (better && better->floats) {
    witness = better->witness;
  } else if (better) {
    result.witness = better->witness;
    result.target = better->target;
  }
  return result;
}

}  // namespace

std::string proofName(Proof proof) {
  constexpr const char* kNames[] = {"proven", "improved", "point", "contained", "rounded", "disproved"};
  return kNames[size_t(proof)];
}

double CellProofs::provenShare() const {
  const uint64_t proven =
      counts[size_t(Proof::kProven)] + counts[size_t(Proof::kImproved)] + counts[size_t(Proof::kPoint)];
  const uint64_t open_count = counts[size_t(Proof::kRounded)] + counts[size_t(Proof::kDisproved)];
  return proven + open_count == 0 ? 1 : double(proven) / double(proven + open_count);
}

CellProofs verifyCell(const Judge& judge, const Scene& scene, CellPvs& pvs, const VerifyOptions& options) {
  const std::vector<uint32_t> contained = containedTriangles(scene, pvs.cell);
  const CellSight sight(pvs.cell);
  std::vector<OpenProof> findings(pvs.triangles.size());
  tbb::parallel_for(size_t(0), findings.size(), [&](size_t i) {
    const uint32_t triangle = pvs.triangles[i];
    const bool no_ray = pvs.witnesses[i].stage == kStageContained;
    Fault fault = sight.faultOf(judge.corners(triangle), pvs.witnesses[i]);
    if (fault == Fault::kNone && no_ray && !std::binary_search(contained.begin(), contained.end(), triangle))
      fault = Fault::kApart;
    if (fault != Fault::kNone || no_ray) {
      const Proof proof = fault == Fault::kNone ? Proof::kContained : Proof::kDisproved;
      findings[i] = {triangle, proof, fault, pvs.witnesses[i], 0, {}};
    } else {
      findings[i] = judgeWitness(judge, sight, triangle, pvs.witnesses[i], options);
    }
  });

  CellProofs proofs;
  proofs.cell = pvs.cell.name;
  for (const OpenProof& finding : findings) {
    ++proofs.counts[size_t(finding.proof)];
    const bool open = finding.proof == Proof::kPoint || finding.proof == Proof::kRounded ||
                      finding.proof == Proof::kDisproved;
    if (finding.proof == Proof::kDisproved) ++proofs.faults[size_t(finding.fault)];
    if (open) proofs.open.push_back(finding);
  }
  return proofs;
}

void removeDisproved(const CellProofs& proofs, CellPvs& pvs) {
  size_t kept = 0;
  auto open = proofs.open.begin();
  for (size_t i = 0; i < pvs.triangles.size(); ++i) {
    while (open != proofs.open.end() && open->triangle < pvs.triangles[i]) ++open;
    const bool is_open = open != proofs.open.end() && open->triangle == pvs.triangles[i];
    if (is_open && open->proof == Proof::kDisproved) continue;
    pvs.triangles[kept] = pvs.triangles[i];
    pvs.witnesses[kept++] = pvs.witnesses[i];
  }
  pvs.triangles.resize(kept);
  pvs.witnesses.resize(kept);
  pvs.stats.contained_triangles =
      uint64_t(std::count_if(pvs.witnesses.begin(), pvs.witnesses.end(),
                             [](const Witness& witness) { return witness.stage == kStageContained; }));
}

}  // namespace sightline

// Hard cases on every device that is here, judged exactly; and docs/numerics.md must say what comes out.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "core/crosscheck/crosscheck.h"
#include "core/device/registry/make_device.h"
#include "core/gvs/bake_cell.h"
#include "core/verify/verify.h"
#include "tests/hard/hard_cases.h"

namespace sightline {
namespace {

/// Of each kind, for each case: all of them go before the judge.
constexpr uint64_t kRays = 250;

/// Our own intersector: what it promises, it keeps on every device that runs it.
bool isOurs(const std::string& device) {
  return device == "cpu" || device.starts_with("opencl");
}

struct Totals {
  uint64_t rays = 0;
  std::array<uint64_t, kVerdicts> verdicts{};
  std::string worst;
};

/// baker: finds the rays' targets.
Totals trace(const hard::HardCase& c, const Bvh& bvh, Tracer& device, Device& baker) {
  CrosscheckOptions options;
  options.rays = kRays;
  options.check_every = 1;
  Tracer* const devices[] = {&device};
  const CrosscheckReport report = crosscheck(c.scene, bvh, std::span(&c.cell, 1), devices, baker, options);
  Totals totals;
  for (const KindReport& kind : report.kinds) {
    totals.rays += kind.rays;
    for (uint32_t v = 0; v < kVerdicts; ++v) totals.verdicts[v] += kind.devices[0].verdicts(Verdict(v));
    const uint64_t bad =
        kind.devices[0].verdicts(Verdict::kMissed) + kind.devices[0].verdicts(Verdict::kWrong);
    if (bad > 0) totals.worst += fmt::format(" {} of {}", bad, rayKindName(kind.kind));
  }
  return totals;
}

/// Cells of the row of docs/numerics.md that begins with the case's name; empty: there is none.
std::vector<std::string> documentedRow(const std::string& name) {
  std::ifstream file(SL_SOURCE_DIR "/docs/numerics.md");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("| " + name + " | ", 0) != 0) continue;
    std::vector<std::string> cells;
    for (size_t at = 2; at < line.size();) {
      const size_t end = line.find(" |", at);
      if (end == std::string::npos) break;
      cells.push_back(line.substr(at, end - at));
      at = end + 3;
    }
    return cells;
  }
  return {};
}

std::string proofText(const CellProofs& proofs) {
  const auto count = [&](Proof proof) { return proofs.counts[size_t(proof)]; };
  return fmt::format("{} of {}", count(Proof::kProven) + count(Proof::kImproved) + count(Proof::kPoint),
                     count(Proof::kProven) + count(Proof::kImproved) + count(Proof::kPoint) +
                         count(Proof::kRounded) + count(Proof::kDisproved));
}

CellPvs bake(const hard::HardCase& c, Device& device) {
  BakeParams params;
  params.n_rand = 20'000;
  params.max_rays = 1'000'000;
  params.validation_rays = 0;
  return bakeCell(device, c.scene, c.cell, 0, params);
}

/// A case by its place in hardCases().
class Hard : public testing::TestWithParam<size_t> {
 protected:
  const hard::HardCase case_ = hard::hardCases()[GetParam()];
  const Bvh bvh_ = buildBvh(case_.scene.positions, case_.scene.triangles);
};

TEST_P(Hard, NoRayIsLostAndNoTriangleIsMadeUp) {
  const auto cpu = makeDevice("cpu", case_.scene, bvh_);
  for (const DeviceInfo& info : listDevices()) {
    if (!info.unusable.empty()) continue;
    const auto device = makeTracer(info.id, case_.scene, bvh_);
    const Totals totals = trace(case_, bvh_, *device, *cpu);
    const uint64_t missed = totals.verdicts[size_t(Verdict::kMissed)];
    const uint64_t wrong = totals.verdicts[size_t(Verdict::kWrong)];
    EXPECT_GT(totals.rays, 5 * kRays);
    if (!isOurs(info.id)) {
      if (missed + wrong > 0) {
        fmt::print("{}, {}: {} missed, {} wrong of {}:{}\n", info.id, case_.name, missed, wrong, totals.rays,
                   totals.worst);
      }
      continue;
    }
    EXPECT_EQ(missed, 0u) << info.id << ":" << totals.worst;
    EXPECT_EQ(wrong, 0u) << info.id << ":" << totals.worst;
  }
}

/// Our own devices bake the same set; what a driver's intersector finds must be seen, too.
TEST_P(Hard, NoDeviceBakesATriangleThatIsNotSeen) {
  const auto cpu = makeDevice("cpu", case_.scene, bvh_);
  const CellPvs expected = bake(case_, *cpu);
  const Judge judge(case_.scene, bvh_);
  for (const DeviceInfo& info : listDevices()) {
    if (!info.unusable.empty() || info.id == "cpu" || !whyNoBakes(info.id).empty()) continue;
    const auto device = makeDevice(info.id, case_.scene, bvh_);
    CellPvs pvs = bake(case_, *device);
    if (isOurs(info.id)) {
      EXPECT_EQ(pvs.triangles, expected.triangles) << info.id;
      continue;
    }
    const CellProofs proofs = verifyCell(judge, case_.scene, pvs);
    EXPECT_EQ(proofs.counts[size_t(Proof::kDisproved)], 0u) << info.id << "\n" << verifyTable({proofs});
    EXPECT_GE(pvs.triangles.size(), expected.triangles.size() / 2) << info.id;
  }
}

TEST_P(Hard, TheTableInTheDocumentsIsTrue) {
  const auto device = makeDevice("cpu", case_.scene, bvh_);
  const Totals totals = trace(case_, bvh_, *device, *device);
  CellPvs pvs = bake(case_, *device);
  const CellProofs proofs = verifyCell(Judge(case_.scene, bvh_), case_.scene, pvs);
  EXPECT_EQ(proofs.counts[size_t(Proof::kDisproved)], 0u) << verifyTable({proofs});

  const double rounded = double(totals.verdicts[size_t(Verdict::kRounded)]) / double(totals.rays);
  const std::vector<std::string> row = {
      case_.name,
      std::to_string(case_.scene.triangles.size()),
      std::to_string(totals.rays),
      std::to_string(totals.verdicts[size_t(Verdict::kMissed)] + totals.verdicts[size_t(Verdict::kWrong)]),
      fmt::format("{:.1f} %", 100 * rounded),
      proofText(proofs)};
  EXPECT_EQ(documentedRow(case_.name), row)
      << fmt::format("docs/numerics.md should have this row:\n| {} |\n", fmt::join(row, " | "));
}

INSTANTIATE_TEST_SUITE_P(Cases, Hard, testing::Range(size_t(0), hard::hardCases().size()));

}  // namespace
}  // namespace sightline

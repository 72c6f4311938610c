#include "core/pvs/cell_summary.h"

#include <xxhash.h>

#include "core/io/byte_stream.h"

namespace sightline {

double CellSummary::mraysPerSecond() const {
  const double seconds = stats.random.seconds + stats.border.seconds + stats.reverse.seconds;
  return seconds > 0 ? double(rays()) / seconds * 1e-6 : 0;
}

double CellSummary::missingShare() const {
  return stats.validation_rays == 0 ? 0 : double(stats.missing_rays) / double(stats.validation_rays);
}

CellSummary summarize(const CellPvs& pvs) {
  const auto hashOf = [](const std::vector<uint32_t>& ids) {
    return XXH3_64bits(ids.data(), ids.size() * sizeof(uint32_t));
  };
  CellSummary summary{pvs.cell, pvs.stats, uint32_t(pvs.triangles.size()), hashOf(pvs.triangles), pvs.device};
  if (pvs.open) {
    summary.open_stats = pvs.open->stats;
    summary.open_added = uint32_t(pvs.open->triangles.size());
    summary.open_hash = hashOf(pvs.open->triangles);
  }
  return summary;
}

std::vector<CellSummary> summarize(const PvsFile& pvs) {
  std::vector<CellSummary> cells;
  for (const CellPvs& cell : pvs.cells) cells.push_back(summarize(cell));
  return cells;
}

uint64_t hashResult(std::span<const CellSummary> cells) {
  ByteWriter out;
  for (const CellSummary& cell : cells) {
    out.number(uint64_t(cell.pvs_size));
    out.number(cell.set_hash);
    if (!cell.open_stats) continue;
    out.number(uint64_t(cell.open_added));
    out.number(cell.open_hash);
  }
  return XXH3_64bits(out.bytes().data(), out.bytes().size());
}

std::string stopReasonName(StopReason reason) {
  switch (reason) {
    case StopReason::kConverged:
      return "converged";
    case StopReason::kRayLimit:
      return "ray limit";
    case StopReason::kTimeLimit:
      return "time limit";
    case StopReason::kTargetError:
      return "target error";
  }
  return "unknown";
}

}  // namespace sightline

#include "core/pvs/pvs_sections.h"

#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>

#include "core/pvs/set_codec.h"

namespace sightline {
namespace {

/// Bytes of a planned cell without its name's characters.
constexpr size_t kPlannedCellBytes = 4 + 9 * 8;
/// Bytes of a witness before compression: origin, direction, stage.
constexpr uint64_t kWitnessBytes = 25;
constexpr uint32_t kFlagWitnesses = 1;

void require(bool condition, const char* problem) {
  if (!condition) throw std::string(problem);
}

void writeParams(ByteWriter& out, const BakeParams& params) {
  out.number(uint32_t(params.method));
  for (uint32_t value : {params.n_rand, params.n_abs_edge, params.n_rs_edge, params.n_rs_area}) {
    out.number(value);
  }
  for (float value :
       {params.delta_abs_relative, params.delta_abs, params.delta_rs_relative, params.delta_rs}) {
    out.number(value);
  }
  for (uint32_t value : {params.threshold, params.quiet_iterations, params.batch_rays}) out.number(value);
  for (uint64_t value : {params.max_rays, params.validation_rays, params.seed}) out.number(value);
  out.number(params.max_seconds);
  out.number(params.raster_resolution);
  out.number(params.target_error);
  out.number(params.abs_spacing);
  out.number(params.reverse_stride);
  out.number(uint32_t(params.order));
}

BakeParams readParams(ByteReader& in) {
  BakeParams params;
  const auto method = in.number<uint32_t>();
  require(method <= uint32_t(Method::kNaive), "unknown method");
  params.method = Method(method);
  for (uint32_t* value : {&params.n_rand, &params.n_abs_edge, &params.n_rs_edge, &params.n_rs_area}) {
    *value = in.number<uint32_t>();
  }
  for (float* value :
       {&params.delta_abs_relative, &params.delta_abs, &params.delta_rs_relative, &params.delta_rs}) {
    *value = in.number<float>();
  }
  for (uint32_t* value : {&params.threshold, &params.quiet_iterations, &params.batch_rays}) {
    *value = in.number<uint32_t>();
  }
  for (uint64_t* value : {&params.max_rays, &params.validation_rays, &params.seed}) {
    *value = in.number<uint64_t>();
  }
  params.max_seconds = in.number<double>();
  params.raster_resolution = in.number<uint32_t>();
  params.target_error = in.number<double>();
  params.abs_spacing = in.number<float>();
  params.reverse_stride = in.number<uint32_t>();
  const auto order = in.number<uint32_t>();
  require(order <= uint32_t(Order::kYield), "unknown order");
  params.order = Order(order);
  return params;
}

void writeStats(ByteWriter& out, const CellStats& stats) {
  for (const StageStats* stage : {&stats.random, &stats.border, &stats.reverse}) {
    out.number(stage->rays);
    out.number(stage->new_triangles);
    out.number(stage->seconds);
  }
  out.number(stats.contained_triangles);
  out.number(stats.iterations);
  out.number(uint32_t(stats.stop));
  for (uint64_t value : {stats.validation_rays, stats.missing_rays, stats.peak_device_bytes}) {
    out.number(value);
  }
  out.number(stats.bound_rays);
  out.number(stats.bound_tests);
  out.number(stats.error_bound);
  out.number(stats.seconds);
}

CellStats readStats(ByteReader& in) {
  CellStats stats;
  for (StageStats* stage : {&stats.random, &stats.border, &stats.reverse}) {
    stage->rays = in.number<uint64_t>();
    stage->new_triangles = in.number<uint64_t>();
    stage->seconds = in.number<double>();
  }
  stats.contained_triangles = in.number<uint64_t>();
  stats.iterations = in.number<uint32_t>();
  const auto stop = in.number<uint32_t>();
  require(stop <= uint32_t(StopReason::kTargetError), "unknown stop reason");
  stats.stop = StopReason(stop);
  for (uint64_t* value : {&stats.validation_rays, &stats.missing_rays, &stats.peak_device_bytes}) {
    *value = in.number<uint64_t>();
  }
  stats.bound_rays = in.number<uint64_t>();
  stats.bound_tests = in.number<uint32_t>();
  stats.error_bound = in.number<double>();
  stats.seconds = in.number<double>();
  return stats;
}

ViewCell readPlannedCell(ByteReader& in) {
  ViewCell cell;
  cell.name = in.text();
  for (glm::dvec3* vector : {&cell.center, &cell.size, &cell.rotation}) {
    for (int axis = 0; axis < 3; ++axis) (*vector)[axis] = in.number<double>();
  }
  return cell;
}

/// Origins, then directions, then stages: equal fields together compress better.
Bytes packWitnesses(const std::vector<Witness>& witnesses) {
  ByteWriter out;
  for (const auto part : {&Witness::origin, &Witness::direction}) {
    for (const Witness& witness : witnesses) {
      for (int axis = 0; axis < 3; ++axis) out.number((witness.*part)[axis]);
    }
  }
  for (const Witness& witness : witnesses) out.number(uint8_t(witness.stage));
  return compress(out.bytes());
}

std::vector<Witness> unpackWitnesses(std::span<const uint8_t> frame, size_t count) {
  const auto content = decompress(frame, count * kWitnessBytes);
  require(content && content->size() == count * kWitnessBytes, "witnesses damaged");
  std::vector<Witness> witnesses(count);
  ByteReader in(*content);
  for (const auto part : {&Witness::origin, &Witness::direction}) {
    for (Witness& witness : witnesses) {
      for (int axis = 0; axis < 3; ++axis) (witness.*part)[axis] = in.number<float>();
    }
  }
  for (Witness& witness : witnesses) {
    witness.stage = in.number<uint8_t>();
    require(witness.stage <= kStageContained, "unknown stage of a witness");
  }
  return witnesses;
}

}  // namespace

Bytes writePrelude() {
  ByteWriter out;
  out.raw(kPvsMagic);
  out.number(kPvsVersion);
  out.number(uint32_t(0));
  return out.bytes();
}

Bytes writeSection(uint32_t kind, std::span<const uint8_t> payload) {
  ByteWriter out;
  out.number(kind);
  out.number(uint32_t(0));
  out.number(uint64_t(payload.size()));
  out.raw(payload);
  out.number(uint64_t(XXH3_64bits(out.bytes().data(), out.bytes().size())));
  return out.bytes();
}

Bytes writeHeadPayload(const PvsFile& pvs) {
  ByteWriter out;
  out.number(pvs.scene_hash);
  out.number(pvs.triangle_count);
  out.number(pvs.has_witnesses ? kFlagWitnesses : 0u);
  writeParams(out, pvs.params);
  out.text(pvs.scene_name);
  out.text(pvs.device);
  out.number(uint32_t(pvs.planned.size()));
  for (const ViewCell& cell : pvs.planned) {
    out.text(cell.name);
    for (const glm::dvec3& vector : {cell.center, cell.size, cell.rotation}) {
      for (int axis = 0; axis < 3; ++axis) out.number(vector[axis]);
    }
  }
  return out.bytes();
}

PvsFile readHeadPayload(std::span<const uint8_t> payload) {
  ByteReader in(payload);
  PvsFile pvs;
  pvs.scene_hash = in.number<uint64_t>();
  pvs.triangle_count = in.number<uint32_t>();
  const auto flags = in.number<uint32_t>();
  require(flags <= kFlagWitnesses, "unknown flags");
  pvs.has_witnesses = (flags & kFlagWitnesses) != 0;
  pvs.params = readParams(in);
  pvs.scene_name = in.text();
  pvs.device = in.text();
  const auto planned = in.number<uint32_t>();
  require(planned <= in.left() / kPlannedCellBytes, "more cells announced than there are");
  pvs.planned.reserve(planned);
  for (uint32_t i = 0; i < planned; ++i) pvs.planned.push_back(readPlannedCell(in));
  require(in.finished(), "head of the wrong size");
  return pvs;
}

Bytes writeCellPayload(const CellPvs& cell, uint32_t index) {
  ByteWriter out;
  out.number(index);
  out.number(uint32_t(cell.triangles.size()));
  writeStats(out, cell.stats);
  const Bytes set = encodeSet(cell.triangles);
  out.number(uint64_t(set.size()));
  out.raw(set);
  if (!cell.witnesses.empty()) out.raw(packWitnesses(cell.witnesses));
  return out.bytes();
}

CellPvs readCellPayload(std::span<const uint8_t> payload, const PvsFile& head, uint32_t index) {
  ByteReader in(payload);
  require(in.number<uint32_t>() == index && index < head.planned.size(), "cell out of order");
  CellPvs cell;
  cell.cell = head.planned[index];
  const auto count = in.number<uint32_t>();
  cell.stats = readStats(in);
  const auto set = in.raw(in.number<uint64_t>());
  require(!in.failed(), "cell of the wrong size");
  auto triangles = decodeSet(set, count, head.triangle_count);
  require(triangles.has_value(), "set of triangles damaged");
  cell.triangles = std::move(*triangles);
  const auto witnesses = in.raw(in.left());
  if (head.has_witnesses && count != 0) cell.witnesses = unpackWitnesses(witnesses, count);
  require(cell.witnesses.size() == (head.has_witnesses ? count : 0) &&
              (witnesses.empty() || !cell.witnesses.empty()),
          "witnesses where none belong");
  return cell;
}

Bytes writeEndPayload(uint32_t cells, uint64_t checksum) {
  ByteWriter out;
  out.number(cells);
  out.number(uint32_t(0));
  out.number(checksum);
  return out.bytes();
}

void checkEndPayload(std::span<const uint8_t> payload, uint32_t cells, uint64_t checksum) {
  const Bytes expected = writeEndPayload(cells, checksum);
  require(std::ranges::equal(payload, expected), "number of cells or checksum of the file differs");
}

}  // namespace sightline

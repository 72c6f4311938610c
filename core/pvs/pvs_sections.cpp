#include "core/pvs/pvs_sections.h"

#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/cell/cell_problem.h"
#include "core/pvs/param_table.h"
#include "core/pvs/set_codec.h"

namespace sightline {
namespace {

/// Bytes of a planned cell without its name's characters.
constexpr size_t kPlannedCellBytes = 4 + 9 * 8;
/// Bytes of a witness before compression: origin, direction, stage.
constexpr uint64_t kWitnessBytes = 25;
constexpr uint32_t kFlagWitnesses = 1, kFlagDoors = 2, kFlagSeeThrough = 4, kFlagOffset = 8;
/// Bytes of named triangles without the name's characters.
constexpr size_t kNamedTrianglesBytes = 4 + 2 * 4;
/// Of programs that wrote no revision.
constexpr uint32_t kFirstAlgorithm = 1;

void require(bool condition, const char* problem) {
  if (!condition) throw Damage(problem);
}

void writeParams(ByteWriter& out, const BakeParams& params, uint32_t version) {
  visitParams(params, [&](const Param& param, const auto& value) {
    if (param.since > version) return;
    if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(value)>>) {
      out.number(uint32_t(value));
    } else {
      out.number(value);
    }
  });
}

template <typename Value>
Value readValue(ByteReader& in, const Param& param, const ParamField<Value>& field) {
  if constexpr (std::is_enum_v<Value>) {
    const auto number = in.number<uint32_t>();
    if (number > uint32_t(field.high)) throw Damage(std::string("unknown ") + param.name);
    return Value(number);
  } else {
    return in.number<Value>();
  }
}

/// Three numbers of which one at least is not 0.
glm::dvec3 readOffset(ByteReader& in) {
  glm::dvec3 offset;
  for (int axis = 0; axis < 3; ++axis) {
    offset[axis] = in.number<double>();
    require(std::isfinite(offset[axis]), "an offset that is none");
  }
  require(offset != glm::dvec3(0.0), "an offset that is none");
  return offset;
}

BakeParams readParams(ByteReader& in, uint32_t version) {
  BakeParams params;
  for (const Param& param : kParams) {
    if (param.since > version) continue;
    std::visit([&](const auto& field) { params.*field.member = readValue(in, param, field); }, param.field);
  }
  return params;
}

void writeStats(ByteWriter& out, const CellStats& stats) {
  for (const StageStats* stage : {&stats.random, &stats.border, &stats.reverse}) {
    out.number(stage->rays);
    out.number(stage->new_triangles);
  }
  out.number(stats.contained_triangles);
  out.number(stats.iterations);
  out.number(uint32_t(stats.stop));
  for (uint64_t value : {stats.validation_rays, stats.missing_rays, stats.bound_rays}) out.number(value);
  out.number(stats.bound_tests);
  out.number(stats.error_bound);
}

double readSeconds(ByteReader& in) {
  const auto seconds = in.number<double>();
  require(std::isfinite(seconds) && seconds >= 0, "a time that is none");
  return seconds;
}

/// with_cost: as versions before 4 have it, times and memory among the counts.
CellStats readStats(ByteReader& in, bool with_cost) {
  CellStats stats;
  for (StageStats* stage : {&stats.random, &stats.border, &stats.reverse}) {
    stage->rays = in.number<uint64_t>();
    stage->new_triangles = in.number<uint64_t>();
    if (with_cost) stage->seconds = readSeconds(in);
  }
  stats.contained_triangles = in.number<uint64_t>();
  stats.iterations = in.number<uint32_t>();
  const auto stop = in.number<uint32_t>();
  require(stop <= uint32_t(StopReason::kTargetError), "unknown stop reason");
  stats.stop = StopReason(stop);
  stats.validation_rays = in.number<uint64_t>();
  stats.missing_rays = in.number<uint64_t>();
  if (with_cost) stats.peak_device_bytes = in.number<uint64_t>();
  stats.bound_rays = in.number<uint64_t>();
  stats.bound_tests = in.number<uint32_t>();
  stats.error_bound = in.number<double>();
  require(stats.error_bound >= 0 && stats.error_bound <= 1, "a bound of the error outside 0 .. 1");
  if (with_cost) stats.seconds = readSeconds(in);
  return stats;
}

void writeObjects(ByteWriter& out, const std::vector<NamedTriangles>& objects) {
  if (objects.empty()) return;
  out.number(uint32_t(objects.size()));
  for (const NamedTriangles& object : objects) {
    out.text(object.name);
    out.number(object.first);
    out.number(object.count);
  }
}

std::vector<NamedTriangles> readObjects(ByteReader& in, uint32_t triangle_count) {
  const auto count = in.number<uint32_t>();
  require(count != 0 && count <= in.left() / kNamedTrianglesBytes, "more objects announced than there are");
  std::vector<NamedTriangles> objects(count);
  uint64_t end = 0;
  for (NamedTriangles& object : objects) {
    object.name = in.text();
    object.first = in.number<uint32_t>();
    object.count = in.number<uint32_t>();
    require(object.count != 0 && object.first >= end, "objects that do not ascend");
    end = uint64_t(object.first) + object.count;
    require(end <= triangle_count, "an object beyond the scene");
  }
  return objects;
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

/// Number of ids, statistics where they are not those of the cell, set.
void writeSet(ByteWriter& out, const std::vector<uint32_t>& triangles, const CellStats& stats) {
  out.number(uint32_t(triangles.size()));
  writeStats(out, stats);
  const Bytes set = encodeSet(triangles);
  out.number(uint64_t(set.size()));
  out.raw(set);
}

std::vector<uint32_t> readSet(ByteReader& in, CellStats& stats, const PvsFile& head) {
  const auto count = in.number<uint32_t>();
  stats = readStats(in, head.version < kPvsVersionWithCosts);
  const auto set = in.raw(in.number<uint64_t>());
  require(!in.failed(), "cell of the wrong size");
  auto triangles = decodeSet(set, count, head.triangle_count);
  require(triangles.has_value(), "set of triangles damaged");
  return std::move(*triangles);
}

}  // namespace

uint32_t versionOf(const PvsFile& pvs) {
  if (pvs.params.bound != 0) return kPvsVersionWithBound;
  const bool plain = pvs.doors.empty() && pvs.see_through.empty() && pvs.params.smallest_hole == 0 &&
                     pvs.offset == glm::dvec3(0.0);
  return plain ? kPvsVersionWithCosts : kPvsVersionWithDoors;
}

Bytes writePrelude(std::span<const uint8_t, sizeof(kPvsMagic)> magic, uint32_t version) {
  ByteWriter out;
  out.raw(magic);
  out.number(version);
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

Section readSection(std::span<const uint8_t> bytes, uint64_t offset) {
  ByteReader in(bytes.subspan(size_t(offset)));
  Section section{in.number<uint32_t>(), {}, offset, 0};
  const auto reserved = in.number<uint32_t>();
  const auto size = in.number<uint64_t>();
  if (in.failed()) throw Damage("cut off in the head of a section");
  section.payload = in.raw(size);
  const auto checksum = in.number<uint64_t>();
  if (in.failed()) throw Damage("cut off in a section");
  section.end = offset + kSectionHeadBytes + size + kSectionChecksumBytes;
  if (checksum != XXH3_64bits(bytes.data() + offset, kSectionHeadBytes + size) || reserved != 0) {
    throw Damage("a section whose checksum is wrong");
  }
  return section;
}

Bytes writeHeadPayload(const PvsFile& pvs) {
  ByteWriter out;
  out.number(pvs.scene_hash);
  out.number(pvs.triangle_count);
  const bool has_offset = pvs.offset != glm::dvec3(0.0);
  out.number((pvs.has_witnesses ? kFlagWitnesses : 0u) | (pvs.doors.empty() ? 0u : kFlagDoors) |
             (pvs.see_through.empty() ? 0u : kFlagSeeThrough) | (has_offset ? kFlagOffset : 0u));
  out.number(pvs.algorithm);
  writeParams(out, pvs.params, versionOf(pvs));
  out.text(pvs.scene_name);
  out.text(pvs.intersector);
  writeObjects(out, pvs.doors);
  writeObjects(out, pvs.see_through);
  for (int axis = 0; has_offset && axis < 3; ++axis) out.number(pvs.offset[axis]);
  out.number(uint32_t(pvs.planned.size()));
  for (const ViewCell& cell : pvs.planned) {
    out.text(cell.name);
    for (const glm::dvec3& vector : {cell.center, cell.size, cell.rotation}) {
      for (int axis = 0; axis < 3; ++axis) out.number(vector[axis]);
    }
  }
  return out.bytes();
}

PvsFile readHeadPayload(std::span<const uint8_t> payload, uint32_t version) {
  ByteReader in(payload);
  PvsFile pvs;
  pvs.version = version;
  pvs.scene_hash = in.number<uint64_t>();
  pvs.triangle_count = in.number<uint32_t>();
  const auto flags = in.number<uint32_t>();
  const uint32_t known = version < kPvsVersionWithDoors
                             ? kFlagWitnesses
                             : kFlagWitnesses | kFlagDoors | kFlagSeeThrough | kFlagOffset;
  require((flags & ~known) == 0, "unknown flags");
  pvs.has_witnesses = (flags & kFlagWitnesses) != 0;
  pvs.algorithm = version < kPvsVersionWithCosts ? kFirstAlgorithm : in.number<uint32_t>();
  pvs.params = readParams(in, version);
  pvs.scene_name = in.text();
  if (version < kPvsVersionWithCosts) {
    pvs.device = in.text();
    if (pvs.device.starts_with("vulkan")) pvs.intersector = pvs.device;
  } else {
    pvs.intersector = in.text();
  }
  if ((flags & kFlagDoors) != 0) pvs.doors = readObjects(in, pvs.triangle_count);
  if ((flags & kFlagSeeThrough) != 0) pvs.see_through = readObjects(in, pvs.triangle_count);
  if ((flags & kFlagOffset) != 0) pvs.offset = readOffset(in);
  const auto planned = in.number<uint32_t>();
  require(planned <= in.left() / kPlannedCellBytes, "more cells announced than there are");
  pvs.planned.reserve(planned);
  for (uint32_t i = 0; i < planned; ++i) pvs.planned.push_back(readPlannedCell(in));
  require(in.finished(), "head of the wrong size");
  if (const auto problem = cellProblem(pvs.planned)) throw Damage(problem->text());
  return pvs;
}

Bytes writeCellPayload(const CellPvs& cell, uint32_t index, const PvsFile& head) {
  const auto requireWitnesses = [&](const auto& set) {
    if (set.witnesses.size() == (head.has_witnesses ? set.triangles.size() : 0)) return;
    throw Error(fmt::format("cell {} has {} witnesses for {} triangles: an error of this program",
                            cell.cell.name, set.witnesses.size(), set.triangles.size()));
  };
  requireWitnesses(cell);
  if (cell.open.has_value() == head.doors.empty()) {
    throw Error(fmt::format("cell {}: an open set without doors, or none with them: an error of this program",
                            cell.cell.name));
  }
  ByteWriter out;
  out.number(index);
  writeSet(out, cell.triangles, cell.stats);
  std::vector<Witness> witnesses = cell.witnesses;
  if (cell.open) {
    requireWitnesses(*cell.open);
    writeSet(out, cell.open->triangles, cell.open->stats);
    witnesses.insert(witnesses.end(), cell.open->witnesses.begin(), cell.open->witnesses.end());
  }
  if (!witnesses.empty()) out.raw(packWitnesses(witnesses));
  return out.bytes();
}

IndexedCell readCellPayload(std::span<const uint8_t> payload, const PvsFile& head) {
  ByteReader in(payload);
  IndexedCell result;
  result.index = in.number<uint32_t>();
  require(result.index < head.planned.size(), "a cell that was not planned");
  CellPvs& cell = result.pvs;
  cell.cell = head.planned[result.index];
  cell.triangles = readSet(in, cell.stats, head);
  size_t count = cell.triangles.size();
  if (!head.doors.empty()) {
    cell.open.emplace();
    cell.open->triangles = readSet(in, cell.open->stats, head);
    std::vector<uint32_t> both;
    std::ranges::set_intersection(cell.triangles, cell.open->triangles, std::back_inserter(both));
    require(both.empty(), "the open set adds what the closed one has");
    count += cell.open->triangles.size();
  }
  const auto witnesses = in.raw(in.left());
  if (head.has_witnesses && count != 0) cell.witnesses = unpackWitnesses(witnesses, count);
  require(cell.witnesses.size() == (head.has_witnesses ? count : 0) &&
              (witnesses.empty() || !cell.witnesses.empty()),
          "witnesses where none belong");
  if (cell.open && head.has_witnesses) {
    const auto opened = cell.witnesses.begin() + ptrdiff_t(cell.triangles.size());
    cell.open->witnesses.assign(opened, cell.witnesses.end());
    cell.witnesses.erase(opened, cell.witnesses.end());
  }
  return result;
}

CellCost costOf(const CellPvs& cell, uint32_t index) {
  const CellStats& stats = cell.stats;
  return {index,
          stats.random.seconds,
          stats.border.seconds,
          stats.reverse.seconds,
          stats.seconds,
          cell.open ? cell.open->stats.seconds : 0,
          stats.peak_device_bytes,
          cell.device};
}

void setCost(CellPvs& cell, const CellCost& cost) {
  cell.stats.random.seconds = cost.random_seconds;
  cell.stats.border.seconds = cost.border_seconds;
  cell.stats.reverse.seconds = cost.reverse_seconds;
  cell.stats.seconds = cost.seconds;
  if (cell.open) cell.open->stats.seconds = cost.open_seconds;
  cell.stats.peak_device_bytes = cost.peak_device_bytes;
  cell.device = cost.device;
}

void writeCost(ByteWriter& out, const CellCost& cost, const PvsFile& head) {
  out.number(cost.index);
  for (double value : {cost.random_seconds, cost.border_seconds, cost.reverse_seconds, cost.seconds}) {
    out.number(value);
  }
  if (!head.doors.empty()) out.number(cost.open_seconds);
  out.number(cost.peak_device_bytes);
  out.text(cost.device);
}

std::vector<CellCost> readCostPayload(std::span<const uint8_t> payload, const PvsFile& head) {
  require(head.version >= kPvsVersionWithCosts, "section of unknown kind");
  ByteReader in(payload);
  std::vector<CellCost> costs;
  while (in.left() != 0) {
    CellCost cost;
    cost.index = in.number<uint32_t>();
    for (double* value : {&cost.random_seconds, &cost.border_seconds, &cost.reverse_seconds, &cost.seconds}) {
      *value = readSeconds(in);
    }
    if (!head.doors.empty()) cost.open_seconds = readSeconds(in);
    cost.peak_device_bytes = in.number<uint64_t>();
    cost.device = in.text();
    require(!in.failed(), "times of cells cut off");
    costs.push_back(std::move(cost));
  }
  return costs;
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

#include <fmt/format.h>

#include "core/base/text.h"
#include "core/io/float_text.h"
#include "core/pvs/stage_name.h"
#include "core/verify/verify.h"

namespace sightline {
namespace {

/// Open proofs that the table lists, over all cells; the JSON has them all.
constexpr size_t kListed = 20;

Json hexVector(const glm::vec3& v) {
  return {hexFloat(v.x), hexFloat(v.y), hexFloat(v.z)};
}

std::string openLine(const std::string& cell, const OpenProof& open) {
  const glm::vec3 o = open.witness.origin, d = open.witness.direction;
  const bool beside = open.fault == Fault::kNone || open.fault == Fault::kNotMet;
  std::string text = fmt::format("{}: triangle {} is {}", cell, open.triangle, proofName(open.proof));
  if (open.fault != Fault::kNone) text += ", " + faultText(open.fault);
  if (beside) text += fmt::format(", {:.2g} steps beside", open.steps_beside);
  if (open.witness.stage == kStageContained) return text + "\n";
  return text + fmt::format(": {} ray from {} {} {} along {} {} {}\n", stageName(open.witness.stage),
                            hexFloat(o.x), hexFloat(o.y), hexFloat(o.z), hexFloat(d.x), hexFloat(d.y),
                            hexFloat(d.z));
}

/// "flat: of 3 disproved 2: its ray begins off the cell, ..."; nothing where none is disproved.
std::string faultLine(const CellProofs& cell) {
  std::string text;
  for (uint32_t i = 0; i < kFaults; ++i) {
    if (cell.faults[i] == 0) continue;
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", cell.faults[i], faultText(Fault(i)));
  }
  return text.empty() ? text : fmt::format("{}: disproved are {}\n", cell.cell, text);
}

}  // namespace

std::string verifyTable(const std::vector<CellProofs>& cells) {
  size_t width = 4;
  for (const CellProofs& cell : cells) width = std::max(width, cell.cell.size());
  std::string table = fmt::format("{:<{}}", "cell", width);
  for (uint32_t i = 0; i < kProofs; ++i) table += fmt::format("  {:>9}", proofName(Proof(i)));
  table += "    proven share\n";
  for (const CellProofs& cell : cells) {
    table += fmt::format("{:<{}}", cell.cell, width);
    for (const uint64_t count : cell.counts) table += fmt::format("  {:>9}", count);
    table += fmt::format("  {:>12.5f} %\n", 100 * cell.provenShare());
  }
  for (const CellProofs& cell : cells) table += faultLine(cell);
  size_t listed = 0;
  for (const CellProofs& cell : cells) {
    for (const OpenProof& open : cell.open) {
      if (open.proof == Proof::kPoint) continue;
      if (listed++ < kListed) table += openLine(cell.cell, open);
    }
  }
  if (listed > kListed) table += fmt::format("... and {} more (--report lists them all)\n", listed - kListed);
  return table;
}

Json verifyJson(const std::vector<CellProofs>& cells) {
  Json json = Json::array();
  for (const CellProofs& cell : cells) {
    Json its = {{"name", cell.cell}};
    for (uint32_t i = 0; i < kProofs; ++i) its[proofName(Proof(i))] = cell.counts[i];
    its["proven_share"] = cell.provenShare();
    its["faults"] = Json::object();
    for (uint32_t i = 1; i < kFaults; ++i) its["faults"][faultName(Fault(i))] = cell.faults[i];
    its["open"] = Json::array();
    for (const OpenProof& open : cell.open) {
      Json entry = {{"triangle", open.triangle},
                    {"proof", proofName(open.proof)},
                    {"steps_beside", open.steps_beside},
                    {"stage", stageName(open.witness.stage)},
                    {"origin", hexVector(open.witness.origin)},
                    {"direction", hexVector(open.witness.direction)}};
      if (open.proof == Proof::kDisproved) entry["fault"] = faultName(open.fault);
      if (open.proof == Proof::kPoint) entry["target"] = {open.target.x, open.target.y, open.target.z};
      its["open"].push_back(entry);
    }
    json.push_back(its);
  }
  return json;
}

}  // namespace sightline

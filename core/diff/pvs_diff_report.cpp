#include "core/diff/pvs_diff_report.h"

#include <fmt/format.h>

#include "core/base/text.h"

namespace sightline {
namespace {

std::string valueLine(const ValueDifference& difference) {
  return fmt::format("{}: {} in A, {} in B", difference.name, difference.values[0], difference.values[1]);
}

std::string idsText(const SomeIds& ids) {
  return fmt::format("{} ({}{})", counted(ids.count, "triangle"), fmt::join(ids.first, ", "),
                     ids.count > ids.first.size() ? ", ..." : "");
}

Json toJson(const SomeIds& ids) {
  return {{"count", ids.count}, {"first", ids.first}};
}

Json toJson(const std::vector<ValueDifference>& list) {
  Json json = Json::array();
  for (const ValueDifference& difference : list) {
    json.push_back({{"name", difference.name}, {"a", difference.values[0]}, {"b", difference.values[1]}});
  }
  return json;
}

}  // namespace

std::vector<std::string> diffLines(const PvsDiff& diff) {
  std::vector<std::string> lines;
  for (const ValueDifference& difference : diff.inputs) lines.push_back(valueLine(difference));
  lines.insert(lines.end(), diff.unmatched.begin(), diff.unmatched.end());
  for (const CellDiff& cell : diff.cells) {
    const auto say = [&](const std::string& what) {
      lines.push_back(fmt::format("cell {}: {}", cell.name, what));
    };
    if (cell.only[0].count > 0) say(idsText(cell.only[0]) + " in A only");
    if (cell.only[1].count > 0) say(idsText(cell.only[1]) + " in B only");
    if (cell.only_open[0].count > 0) say(idsText(cell.only_open[0]) + " with open doors in A only");
    if (cell.only_open[1].count > 0) say(idsText(cell.only_open[1]) + " with open doors in B only");
    if (cell.witnesses.count > 0) say("other witnesses of " + idsText(cell.witnesses));
    for (const ValueDifference& difference : cell.statistics) say(valueLine(difference));
  }
  return lines;
}

std::string diffVerdict(const PvsDiff& diff) {
  if (diff.same()) {
    return fmt::format("the same: {}, {} in their sets", counted(diff.compared_cells, "cell"),
                       counted(diff.compared_triangles, "triangle"));
  }
  return fmt::format("different: in {}, and {} of {} that both have", counted(diff.inputs.size(), "input"),
                     diff.cells.size(), counted(diff.compared_cells, "cell"));
}

Json diffJson(const PvsDiff& diff) {
  Json cells = Json::array();
  for (const CellDiff& cell : diff.cells) {
    cells.push_back({{"name", cell.name},
                     {"only_a", toJson(cell.only[0])},
                     {"only_b", toJson(cell.only[1])},
                     {"only_open_a", toJson(cell.only_open[0])},
                     {"only_open_b", toJson(cell.only_open[1])},
                     {"witnesses", toJson(cell.witnesses)},
                     {"statistics", toJson(cell.statistics)}});
  }
  return {{"same", diff.same()},
          {"inputs", toJson(diff.inputs)},
          {"unmatched", diff.unmatched},
          {"compared_cells", diff.compared_cells},
          {"compared_triangles", diff.compared_triangles},
          {"cells", cells}};
}

}  // namespace sightline

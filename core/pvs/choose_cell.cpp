#include "core/pvs/choose_cell.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>

#include "core/base/error.h"

namespace sightline {
namespace {

constexpr size_t kNamesShown = 20;

std::string namesOf(const PvsFile& pvs) {
  std::string names;
  for (size_t i = 0; i < std::min(kNamesShown, pvs.cells.size()); ++i) {
    names += (i == 0 ? "" : ", ") + pvs.cells[i].cell.name;
  }
  return names + (pvs.cells.size() > kNamesShown ? ", ..." : "");
}

}  // namespace

const CellPvs& chooseCell(const PvsFile& pvs, const std::string& name_or_index,
                          const std::filesystem::path& file) {
  const auto named = std::find_if(pvs.cells.begin(), pvs.cells.end(),
                                  [&](const CellPvs& cell) { return cell.cell.name == name_or_index; });
  if (named != pvs.cells.end()) return *named;
  size_t index = 0;
  const char* end = name_or_index.data() + name_or_index.size();
  const auto [rest, failure] = std::from_chars(name_or_index.data(), end, index);
  if (failure == std::errc() && rest == end && index < pvs.cells.size()) return pvs.cells[index];
  throw Error(fmt::format("{}: no baked cell \"{}\"; there are {}: {}", file.string(), name_or_index,
                          pvs.cells.size(), namesOf(pvs)),
              kExitUsage);
}

}  // namespace sightline

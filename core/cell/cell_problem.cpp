#include "core/cell/cell_problem.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "core/base/extents.h"

namespace sightline {
namespace {

using Problem = std::optional<CellProblem>;

Problem nameProblem(const std::string& name) {
  if (name.empty()) return CellProblem{"name", "is empty; every cell needs a name"};
  for (const char c : name) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      return CellProblem{"name", "has a control character"};
    }
  }
  return {};
}

Problem finiteProblem(const char* key, const glm::dvec3& value) {
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(value[i])) return CellProblem{fmt::format("{}[{}]", key, i), "is not a finite number"};
  }
  return {};
}

Problem sizeProblem(const glm::dvec3& size) {
  int zeros = 0;
  for (int i = 0; i < 3; ++i) {
    const std::string element = fmt::format("size[{}]", i);
    if (size[i] < 0.0) return CellProblem{element, fmt::format("{} is negative", size[i])};
    if (size[i] == 0.0) ++zeros;
    if (size[i] > 0.0 && size[i] < kSmallestExtent) {
      return CellProblem{element,
                         fmt::format("{} is too small: at least {:g}, or 0", size[i], kSmallestExtent)};
    }
  }
  if (zeros > 1) return CellProblem{"size", "the cell has no area; at most one extent may be 0"};
  return {};
}

Problem distanceProblem(const ViewCell& cell) {
  for (const glm::vec3& corner : cellCorners(cell)) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(corner[axis]) <= kLargestCoordinate) continue;
      return CellProblem{
          "", "reaches farther than 2^40 from the origin, too far to trace: scale scene and cells"};
    }
  }
  return {};
}

}  // namespace

std::optional<CellProblem> cellProblem(const ViewCell& cell) {
  if (auto problem = nameProblem(cell.name)) return problem;
  if (auto problem = finiteProblem("center", cell.center)) return problem;
  if (auto problem = finiteProblem("size", cell.size)) return problem;
  if (auto problem = finiteProblem("rotation", cell.rotation)) return problem;
  if (auto problem = sizeProblem(cell.size)) return problem;
  return distanceProblem(cell);
}

std::optional<CellProblem> cellProblem(std::span<const ViewCell> cells) {
  if (cells.empty()) return CellProblem{"cells", "is empty; at least one view cell is needed"};
  std::set<std::string_view> names;
  for (size_t i = 0; i < cells.size(); ++i) {
    const std::string place = fmt::format("cells[{}]", i);
    if (const auto problem = cellProblem(cells[i])) {
      return CellProblem{place + (problem->place.empty() ? "" : ".") + problem->place, problem->what};
    }
    if (!names.insert(cells[i].name).second) {
      return CellProblem{place + ".name",
                         fmt::format("\"{}\" is the name of an earlier cell", cells[i].name)};
    }
  }
  return {};
}

}  // namespace sightline

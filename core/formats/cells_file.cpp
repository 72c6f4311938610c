#include "core/formats/cells_file.h"

#include <fmt/format.h>

#include <set>

#include "core/base/error.h"
#include "core/cell/cell_problem.h"
#include "core/cell/view_cell.h"
#include "core/formats/json_text.h"
#include "core/io/file_io.h"

namespace sightline {
namespace {

using nlohmann::json;

/// Keys that begin so belong to whoever wrote them, and are not looked at.
constexpr std::string_view kOtherKeys = "x-";

/// Says where in the file something is wrong: "cells.json: cells[3].size: ...".
[[noreturn]] void fail(const std::string& file, const std::string& place, const std::string& what) {
  throw Error(fmt::format("{}: {}: {}", file, place, what));
}

void checkKeys(const json& object, const std::set<std::string>& allowed, const std::string& file,
               const std::string& place) {
  for (const auto& [key, value] : object.items()) {
    if (allowed.contains(key) || key.starts_with(kOtherKeys)) continue;
    fail(file, place,
         fmt::format("unknown key {}, expected one of {}, or {}... for keys of other programs",
                     json(key).dump(), json(allowed).dump(), kOtherKeys));
  }
}

glm::dvec3 readVector(const json& value, const std::string& file, const std::string& place) {
  if (!value.is_array() || value.size() != 3) fail(file, place, "expected three numbers [x, y, z]");
  glm::dvec3 result;
  for (int i = 0; i < 3; ++i) {
    const json& number = value[size_t(i)];
    if (!number.is_number()) fail(file, fmt::format("{}[{}]", place, i), "expected a number");
    result[i] = number.get<double>();
  }
  return result;
}

/// Throws Error if a cell cannot be baked.
void checkCells(const std::vector<ViewCell>& cells, const std::string& file) {
  if (const auto problem = cellProblem(cells)) fail(file, problem->place, problem->what);
}

ViewCell readCell(const json& value, const std::string& file, const std::string& place) {
  if (!value.is_object()) fail(file, place, "expected an object");
  checkKeys(value, {"name", "center", "size", "rotation"}, file, place);
  for (const char* key : {"name", "center", "size"}) {
    if (!value.contains(key)) fail(file, place, fmt::format("key \"{}\" is missing", key));
  }
  if (!value["name"].is_string()) fail(file, place + ".name", "expected a text");
  ViewCell cell;
  cell.name = value["name"].get<std::string>();
  cell.center = readVector(value["center"], file, place + ".center");
  cell.size = readVector(value["size"], file, place + ".size");
  if (value.contains("rotation")) cell.rotation = readVector(value["rotation"], file, place + ".rotation");
  return cell;
}

std::string vectorText(const glm::dvec3& value) {
  return fmt::format("[{}, {}, {}]", json(value.x).dump(), json(value.y).dump(), json(value.z).dump());
}

}  // namespace

std::vector<ViewCell> loadCells(const std::filesystem::path& file) {
  return parseCells(readFile(file).view(), file.string());
}

std::vector<ViewCell> parseCells(std::string_view text, const std::string& file) {
  if (text.empty()) throw Error(fmt::format("{}: is empty, expected {{\"cells\":[...]}}", file));
  const json document = parseJson(text, file);
  if (!document.is_object()) throw Error(fmt::format("{}: expected an object {{\"cells\":[...]}}", file));
  checkKeys(document, {"cells"}, file, "top level");
  if (!document.contains("cells")) fail(file, "top level", "key \"cells\" is missing");
  if (!document["cells"].is_array()) fail(file, "cells", "expected a list");

  std::vector<ViewCell> cells;
  for (const json& value : document["cells"]) {
    cells.push_back(readCell(value, file, fmt::format("cells[{}]", cells.size())));
  }
  checkCells(cells, file);
  return cells;
}

std::string cellsText(const std::vector<ViewCell>& cells, const std::string& file) {
  std::string text = "{\"cells\": [\n";
  try {
    checkCells(cells, file);
    for (size_t i = 0; i < cells.size(); ++i) {
      text += fmt::format("  {{\"name\": {}, \"center\": {}, \"size\": {}, \"rotation\": {}}}{}\n",
                          json(cells[i].name).dump(), vectorText(cells[i].center), vectorText(cells[i].size),
                          vectorText(cells[i].rotation), i + 1 < cells.size() ? "," : "");
    }
  } catch (const json::exception&) {
    throw Error(fmt::format("{}: a cell's name is not valid UTF-8", file));
  }
  return text + "]}\n";
}

void saveCells(const std::vector<ViewCell>& cells, const std::filesystem::path& file) {
  saveText(cellsText(cells, file.string()), file);
}

}  // namespace sightline

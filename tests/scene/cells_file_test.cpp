#include "core/formats/cells_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/cell/view_cell.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::errorOf;
using test::Folder;

std::string cellsError(std::string_view text) {
  const Folder folder;
  return errorOf([&] { loadCells(folder.write("cells.json", text)); });
}

/// A file of one cell with these members.
std::string oneCell(const std::string& members) {
  return "{\"cells\":[{" + members + "}]}";
}

TEST(CellsFile, ReadsCells) {
  const Folder folder;
  const auto file = folder.write("c.json", R"({"cells":[
    {"name":"a","center":[1,2.5,-3],"size":[4,5,6],"rotation":[7,8,9]},
    {"name":"b","center":[0,0,0],"size":[1,1,0]}]})");
  const std::vector<ViewCell> cells = loadCells(file);
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[0].name, "a");
  EXPECT_EQ(cells[0].center, glm::dvec3(1, 2.5, -3));
  EXPECT_EQ(cells[0].size, glm::dvec3(4, 5, 6));
  EXPECT_EQ(cells[0].rotation, glm::dvec3(7, 8, 9));
  EXPECT_EQ(cells[1].rotation, glm::dvec3(0));
  EXPECT_TRUE(cells[1].flat());
}

TEST(CellsFile, ErrorsNameThePlace) {
  const std::string good = R"("name":"a","center":[1,2,3],"size":[1,1,1])";
  const std::pair<std::string, std::string> cases[] = {
      {"", "cells.json: is empty, expected {\"cells\":[...]}"},
      {"[]", "cells.json: expected an object {\"cells\":[...]}"},
      {"{}", "cells.json: top level: key \"cells\" is missing"},
      {R"({"cells":[],"more":1})", R"(cells.json: top level: unknown key "more", expected one of ["cells"], )"
                                   R"(or x-... for keys of other programs)"},
      {R"({"cells":{}})", "cells.json: cells: expected a list"},
      {R"({"cells":[]})", "cells.json: cells: is empty; at least one view cell is needed"},
      {R"({"cells":[7]})", "cells.json: cells[0]: expected an object"},
      {oneCell(good + R"(,"siz":[1,1,1])"),
       R"(cells.json: cells[0]: unknown key "siz", expected one of ["center","name","rotation","size"], )"
       R"(or x-... for keys of other programs)"},
      {oneCell(R"("name":"a","size":[1,1,1])"), R"(cells.json: cells[0]: key "center" is missing)"},
      {oneCell(R"("name":"a","center":[1,1,1])"), R"(cells.json: cells[0]: key "size" is missing)"},
      {oneCell(R"("center":[1,1,1],"size":[1,1,1])"), R"(cells.json: cells[0]: key "name" is missing)"},
      {oneCell(R"("name":7,"center":[1,1,1],"size":[1,1,1])"), "cells.json: cells[0].name: expected a text"},
      {oneCell(R"("name":"","center":[1,1,1],"size":[1,1,1])"),
       "cells.json: cells[0].name: is empty; every cell needs a name"},
      {oneCell(R"("name":"a\n","center":[1,1,1],"size":[1,1,1])"),
       "cells.json: cells[0].name: has a control character"},
      {oneCell(R"("name":"a","center":[1,1],"size":[1,1,1])"),
       "cells.json: cells[0].center: expected three numbers [x, y, z]"},
      {oneCell(R"("name":"a","center":[1,1,1,1],"size":[1,1,1])"),
       "cells.json: cells[0].center: expected three numbers [x, y, z]"},
      {oneCell(R"("name":"a","center":[1,"1",1],"size":[1,1,1])"),
       "cells.json: cells[0].center[1]: expected a number"},
      {oneCell(R"("name":"a","center":[1,1,1],"size":[1,-2,1])"),
       "cells.json: cells[0].size[1]: -2 is negative"},
      {oneCell(R"("name":"a","center":[1,1,1],"size":[0,1,0])"),
       "cells.json: cells[0].size: the cell has no area; at most one extent may be 0"},
      {oneCell(R"("name":"a","center":[1,1,1],"size":[0,0,0])"),
       "cells.json: cells[0].size: the cell has no area; at most one extent may be 0"},
      {oneCell(R"("name":"a","center":[1,1,1],"size":[1,1e-60,1])"),
       "cells.json: cells[0].size[1]: 1e-60 is too small: at least 8.67362e-19, or 0"},
      {oneCell(R"("name":"a","center":[1,1e39,1],"size":[1,1,1])"),
       "cells.json: cells[0]: reaches farther than 2^40 from the origin, too far to trace: scale scene and "
       "cells"},
      {oneCell(R"("name":"a","center":[1,1,1],"size":[1,1,1],"rotation":5)"),
       "cells.json: cells[0].rotation: expected three numbers [x, y, z]"},
      {"{\"cells\":[{" + good + "},{" + good + "}]}",
       R"(cells.json: cells[1].name: "a" is the name of an earlier cell)"},
      {oneCell(good + R"(,"name":"b")"), R"(cells.json: key "name" occurs twice in one object)"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(cellsError(text), message) << text;
}

TEST(CellsFile, KeysOfOtherProgramsArePassedOver) {
  const Folder folder;
  const auto file = folder.write("c.json", R"({"x-editor":{"version":[1,{"cells":0}]},"cells":[
    {"name":"a","center":[1,2,3],"size":[4,5,6],"x-tags":["street",7],"x-":null}],"x-cells":[]})");
  const std::vector<ViewCell> cells = loadCells(file);
  ASSERT_EQ(cells.size(), 1u);
  EXPECT_EQ(cells[0], (ViewCell{"a", {1, 2, 3}, {4, 5, 6}, glm::dvec3(0)}));
  for (const char* key : {"x", "X-tags", "xtags", "-x-tags", ""}) {
    EXPECT_NE(
        cellsError(oneCell(std::string(R"("name":"a","center":[1,2,3],"size":[1,1,1],")") + key + R"(":0)"))
            .find("unknown key"),
        std::string::npos)
        << key;
  }
}

TEST(CellsFile, SyntaxErrorsNameLineAndColumn) {
  EXPECT_EQ(cellsError("{\"cells\":\n [ } ]}").substr(0, 15), "cells.json:2:4:");
  EXPECT_EQ(cellsError("{").substr(0, 15), "cells.json:1:2:");
  EXPECT_NE(cellsError(oneCell(R"("name":"a","center":[1,1e999,1],"size":[1,1,1])")).find("1e999"),
            std::string::npos);
  EXPECT_NE(cellsError(std::string(100'000, '[')).find("nested deeper"), std::string::npos);
  EXPECT_NE(cellsError("{\"cells\":[{\"name\":\"\xff\"}]}").find("cells.json:1:"), std::string::npos);
}

TEST(CellsFile, MissingFileAndFolder) {
  const Folder folder;
  EXPECT_EQ(errorOf([&] { loadCells(folder / "no.json"); }),
            "no.json: cannot open: No such file or directory");
  std::filesystem::create_directory(folder / "dir.json");
  EXPECT_EQ(errorOf([&] { loadCells(folder / "dir.json"); }), "dir.json: is a directory, not a file");
}

TEST(CellsFile, SavedCellsReadBackExactly) {
  const Folder folder;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> value(-1000.0, 1000.0);
  std::vector<ViewCell> cells;
  for (int i = 0; i < 200; ++i) {
    ViewCell cell;
    cell.name = "cell \"" + std::to_string(i) + "\" \xc3\xa4";
    cell.center = {value(random), value(random), value(random)};
    cell.size = {std::fabs(value(random)), std::fabs(value(random)), i % 3 == 0 ? 0.0 : 0.1};
    cell.rotation = {value(random), -0.0, value(random) * 1e-300};
    cells.push_back(cell);
  }
  saveCells(cells, folder / "cells.json");
  const std::vector<ViewCell> loaded = loadCells(folder / "cells.json");
  ASSERT_EQ(loaded.size(), cells.size());
  for (size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(loaded[i].name, cells[i].name);
    EXPECT_EQ(loaded[i].center, cells[i].center);
    EXPECT_EQ(loaded[i].size, cells[i].size);
    EXPECT_EQ(loaded[i].rotation, cells[i].rotation);
  }
}

TEST(CellsFile, SavingRefusesWhatLoadingWould) {
  const Folder folder;
  ViewCell cell;
  cell.name = "a";
  cell.size = {1.0, 1.0, std::nan("")};
  EXPECT_EQ(errorOf([&] { saveCells({cell}, folder / "c.json"); }),
            "c.json: cells[0].size[2]: is not a finite number");
  cell.size = glm::dvec3(1.0);
  cell.name = "\xff";
  EXPECT_EQ(errorOf([&] { saveCells({cell}, folder / "c.json"); }),
            "c.json: a cell's name is not valid UTF-8");
  EXPECT_FALSE(std::filesystem::exists(folder / "c.json"));
}

}  // namespace
}  // namespace sightline

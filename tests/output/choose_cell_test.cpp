#include "core/pvs/choose_cell.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace sightline {
namespace {

PvsFile cellsNamed(const std::vector<std::string>& names) {
  PvsFile pvs;
  for (const std::string& name : names) {
    pvs.cells.emplace_back();
    pvs.cells.back().cell.name = name;
  }
  return pvs;
}

TEST(ChooseCell, TakesTheNameBeforeTheIndex) {
  const PvsFile pvs = cellsNamed({"street", "0", "yard"});
  EXPECT_EQ(&chooseCell(pvs, "yard", "a.pvs"), &pvs.cells[2]);
  EXPECT_EQ(&chooseCell(pvs, "2", "a.pvs"), &pvs.cells[2]);
  EXPECT_EQ(&chooseCell(pvs, "0", "a.pvs"), &pvs.cells[1]);
  EXPECT_EQ(&chooseCell(pvs, "1", "a.pvs"), &pvs.cells[1]);
}

TEST(ChooseCell, SaysWhichCellsThereAre) {
  const PvsFile pvs = cellsNamed({"street", "yard"});
  for (const char* wrong : {"2", "-1", "1 ", "1x", "", "Yard", "99999999999999999999999"}) {
    try {
      chooseCell(pvs, wrong, "a.pvs");
      ADD_FAILURE() << "\"" << wrong << "\" was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.what(),
                std::string("a.pvs: no baked cell \"") + wrong + "\"; there are 2: street, yard");
      EXPECT_EQ(error.exitCode(), kExitUsage);
    }
  }
}

}  // namespace
}  // namespace sightline

#include <gtest/gtest.h>

#include "core/io/file_io.h"
#include "core/pvs/pvs_writer.h"
#include "tests/output/example_pvs.h"
#include "tests/output/system_calls.h"

namespace sightline {
namespace {

/// The log with every temporary name after `file` as "TMP", and the folder as "FOLDER/".
std::vector<std::string> plainLog(const std::string& file, const TemporaryFolder& folder) {
  std::vector<std::string> log = SystemCalls::log;
  for (std::string& line : log) {
    const size_t name = line.find(file + ".tmp");
    if (name != std::string::npos) line.replace(name, line.find(' ', name) - name, "TMP");
    if (line == "fsync " + folder.path().filename().string() + "/") line = "fsync FOLDER/";
  }
  return log;
}

/// Else a power cut after it could leave an empty file under the name, and none of the old one.
TEST(OutputFile, IsOnTheDiskBeforeItHasItsName) {
  const TemporaryFolder folder;
  SystemCalls::log.clear();
  saveText("text", folder / "x.txt");
  EXPECT_EQ(plainLog("x.txt", folder),
            (std::vector<std::string>{"fsync TMP", "rename TMP x.txt", "fsync FOLDER/"}));
  SystemCalls::log.clear();
  savePvs(examplePvs(), folder / "x.pvs");
  EXPECT_EQ(plainLog("x.pvs", folder),
            (std::vector<std::string>{"fsync TMP", "rename TMP x.pvs", "fsync FOLDER/"}));
}

TEST(OutputFile, ABakeIsOnTheDiskBeforeItHasItsName) {
  const TemporaryFolder folder;
  PvsWriter writer(folder / "x.pvs.part");
  writer.begin(examplePvs());
  SystemCalls::log.clear();
  writer.finish(folder / "x.pvs");
  EXPECT_EQ(plainLog("x.pvs.part", folder),
            (std::vector<std::string>{"fsync TMP", "rename TMP x.pvs.part", "fsync FOLDER/",
                                      "fsync x.pvs.part", "rename x.pvs.part x.pvs", "fsync FOLDER/"}));
}

TEST(OutputFile, TwoOfOneNameDoNotMeet) {
  const TemporaryFolder folder;
  OutputFile first(folder / "x.txt"), second(folder / "x.txt");
  first.write("first");
  second.write("second");
  second.commit();
  first.commit();
  EXPECT_EQ(readFile(folder / "x.txt").view(), "first");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

}  // namespace
}  // namespace sightline

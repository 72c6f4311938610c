// Results are not replaced without being asked; what is made of them is.
#include <gtest/gtest.h>

#include "tests/cli/run_program.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::Folder;
using test::ProgramRun;
using test::readText;
using test::runProgram;

void expectKept(const std::string& arguments, const std::filesystem::path& file) {
  const std::string before = readText(file);
  const ProgramRun run = runProgram(arguments);
  EXPECT_EQ(run.exit_code, 1) << arguments << "\n" << run.output;
  EXPECT_NE(run.output.find(file.string() + ": is there already; name another file, or --overwrite it\n"),
            std::string::npos)
      << run.output;
  EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << run.output;
  EXPECT_EQ(readText(file), before) << arguments;
}

TEST(Overwrite, AResultIsReplacedOnlyWhenAskedFor) {
  const Folder folder;
  const auto scene = folder / "s.obj", cells = folder / "c.json", other = folder / "o.obj",
             pvs = folder / "x.pvs", better = folder / "better.pvs";
  const std::string plant = "scene plant --triangles 1000 ";
  ASSERT_EQ(runProgram(plant + "-o " + scene.string()).exit_code, 0);
  expectKept(plant + "--seed 2 -o " + scene.string(), scene);
  folder.write("c.json", R"({"cells": [{"name": "mine", "center": [0, 50, 0], "size": [1, 1, 1]}]})");
  expectKept(plant + "-o " + other.string() + " --cells " + cells.string(), cells);
  EXPECT_FALSE(std::filesystem::exists(other)) << "it was generated before the cells were looked at";

  ASSERT_EQ(runProgram("bake " + scene.string() + " --cells " + cells.string() + " -o " + pvs.string() +
                       " --device cpu --n-rand 5000 --validation-rays 0 --witnesses")
                .exit_code,
            0);
  const std::string verify =
      "verify " + scene.string() + " " + pvs.string() + " --min-proven 0 -o " + better.string();
  ASSERT_EQ(runProgram(verify).exit_code, 0);
  folder.write("better.pvs", "hours of work");
  expectKept(verify, better);
  ASSERT_EQ(runProgram(verify + " --overwrite").exit_code, 0);
  EXPECT_NE(readText(better), "hours of work");

  const std::string before = readText(scene);
  ASSERT_EQ(runProgram(plant + "--seed 2 --overwrite -o " + scene.string() + " --cells " + cells.string())
                .exit_code,
            0);
  EXPECT_NE(readText(scene), before);
  EXPECT_EQ(readText(cells).find("mine"), std::string::npos);
}

TEST(Overwrite, WhatIsMadeOfAResultIsReplaced) {
  const Folder folder;
  const std::string scene = (folder / "s.obj").string(),
                    cells = folder
                                .write("c.json", R"({"cells": [
      {"name": "mine", "center": [0, 50, 0], "size": [1, 1, 1]}]})")
                                .string(),
                    pvs = (folder / "x.pvs").string();
  ASSERT_EQ(runProgram("scene plant --triangles 1000 -o " + scene).exit_code, 0);
  for (const char* name : {"r.json", "r.html", "r.csv", "m.csv", "ids.txt", "p.png"})
    folder.write(name, "old");
  const auto at = [&](const char* name) { return (folder / name).string(); };
  for (const std::string& command :
       {"bake " + scene + " --cells " + cells + " -o " + pvs +
            " --device cpu --n-rand 5000 --validation-rays 0 --report " + at("r.json") + " --html " +
            at("r.html") + " --csv " + at("r.csv"),
        "measure " + scene + " " + pvs + " --device cpu --views 1 --resolution 16 --csv " + at("m.csv"),
        "export " + pvs + " --cell mine --format ids -o " + at("ids.txt"),
        "picture " + scene + " " + pvs + " --cell mine --device cpu -o " + at("p.png")}) {
    const ProgramRun run = runProgram(command);
    EXPECT_EQ(run.exit_code, 0) << command << "\n" << run.output;
  }
  for (const char* name : {"r.json", "r.html", "r.csv", "m.csv", "ids.txt", "p.png"}) {
    EXPECT_NE(readText(folder / name), "old") << name;
  }
}

}  // namespace
}  // namespace sightline

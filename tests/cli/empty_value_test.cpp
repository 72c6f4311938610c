// An option's value that is empty, as of a shell's variable that is not set, must not count as not given.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/cli/run_program.h"

namespace sightline {
namespace {

TEST(EmptyValues, AreRefusedByEveryCommand) {
  for (const char* arguments : {"bake s.obj --cells c.json -o x.pvs --report ''",
                                "bake s.obj --cells c.json -o x.pvs --csv ''",
                                "bake s.obj --cells c.json -o x.pvs --html ''",
                                "bake s.obj --cells c.json -o x.pvs --pictures ''",
                                "bake s.obj --cells c.json -o ''",
                                "measure s.obj x.pvs --report ''",
                                "measure s.obj x.pvs --csv ''",
                                "measure s.obj x.pvs --html ''",
                                "measure s.obj x.pvs --pictures ''",
                                "compare s.obj --cells c.json --rays 9 --report ''",
                                "compare s.obj --cells c.json --rays 9 --csv ''",
                                "compare s.obj --cells c.json --rays 9 --html ''",
                                "crosscheck s.obj --cells c.json --devices cpu --report ''",
                                "verify s.obj x.pvs --report ''",
                                "verify s.obj x.pvs -o ''",
                                "scene city -o s.obj --cells ''",
                                "cells s.obj -o c.json --grid 9 --origin ''",
                                "export x.pvs --cell 0 --format json -o x.json --scene ''",
                                "picture s.obj '' --cell 0 -o p.png",
                                "info ''"}) {
    const test::ProgramRun run = test::runProgram(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments << "\n" << run.output;
    EXPECT_NE(run.output.find(": is empty; give a value"), std::string::npos) << arguments << "\n"
                                                                              << run.output;
    EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << run.output;
  }
}

}  // namespace
}  // namespace sightline

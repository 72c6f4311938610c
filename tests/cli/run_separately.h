#pragma once
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

namespace sightline::test {

/// What the program said on standard output, and elsewhere on standard error.
struct SeparateRun {
  std::string output, errors;
  int exit_code = -1;
};

/// Runs sightline in the folder, with the arguments as a shell reads them.
inline SeparateRun runSeparately(const std::string& arguments, const std::filesystem::path& folder) {
  const auto file = [&](const char* name) { return (folder / name).string(); };
  const std::string command = "exec </dev/null; cd '" + folder.string() + "' && '" SL_PROGRAM "' " +
                              arguments + " >'" + file(".stdout") + "' 2>'" + file(".stderr") + "'";
  const int status = std::system(command.c_str());
  SeparateRun run;
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  for (auto [name, text] : {std::pair(".stdout", &run.output), std::pair(".stderr", &run.errors)}) {
    std::ifstream in(file(name), std::ios::binary);
    text->assign(std::istreambuf_iterator<char>(in), {});
    std::filesystem::remove(file(name));
  }
  return run;
}

}  // namespace sightline::test

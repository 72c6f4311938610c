#pragma once
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace sightline::test {

/// What the program said, standard output and error together, and its exit code (-1: it was killed).
struct ProgramRun {
  std::string output;
  int exit_code = -1;
};

/// Runs sightline with the arguments, as a shell reads them. environment: settings for it, "NAME=VALUE ...".
inline ProgramRun runProgram(const std::string& arguments, const std::string& environment = "") {
  FILE* pipe = popen((environment + " '" SL_PROGRAM "' " + arguments + " 2>&1 </dev/null").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("popen failed");
  ProgramRun run;
  std::array<char, 4096> buffer;
  for (size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) run.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

}  // namespace sightline::test

#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

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

/// Runs it, and expects the exit code and these parts of what it says.
inline ProgramRun expectRun(const std::string& arguments, int exit_code,
                            const std::vector<std::string>& said) {
  const ProgramRun run = runProgram(arguments);
  EXPECT_EQ(run.exit_code, exit_code) << arguments << "\n" << run.output;
  for (const std::string& text : said) {
    EXPECT_NE(run.output.find(text), std::string::npos) << "expected: " << text << "\n" << run.output;
  }
  return run;
}

/// A program that runs beside the test.
class Running {
 public:
  Running(const std::string& arguments, const std::string& output) {
    pid_ = ::fork();
    if (pid_ != 0) return;
    const int file = ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    ::dup2(file, 1);
    ::dup2(file, 2);
    const std::string command = "exec '" SL_PROGRAM "' " + arguments;
    ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    ::_exit(127);
  }
  void send(int signal) { ::kill(pid_, signal); }
  /// Exit code, or minus the signal that ended it.
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  }

 private:
  pid_t pid_;
};

}  // namespace sightline::test

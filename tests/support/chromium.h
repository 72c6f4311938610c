#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

// A real browser for tests of HTML reports: Debian's chromium, without a window.
namespace sightline::testing_support {

/// What a program said and its exit code (-1: killed).
struct BrowserRun {
  std::string output;
  int exit_code = -1;
};

/// Runs chromium with the arguments, as a shell reads them. Settings and caches go into `profile`, and
/// nothing may be looked up in a network.
inline BrowserRun runChromium(const std::filesystem::path& profile, const std::string& arguments) {
  const std::string command =
      "timeout 60 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run "
      "--disable-background-networking --disable-component-update --disable-sync --hide-scrollbars "
      "--host-resolver-rules='MAP * ~NOTFOUND' --user-data-dir='" +
      profile.string() + "' " + arguments + " 2>'" + (profile.string() + ".log") + "' </dev/null";
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  BrowserRun run;
  std::array<char, 4096> buffer;
  for (size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) run.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

/// Whether there is a chromium. Where SIGHTLINE_REQUIRE_CHROMIUM is set (build.sh test sets it, as it
/// installs one), there being none is a failure and no reason to skip.
inline bool hasChromium() {
  if (std::system("command -v chromium >/dev/null") == 0) return true;
  if (std::getenv("SIGHTLINE_REQUIRE_CHROMIUM")) ADD_FAILURE() << "there is no chromium";
  return false;
}

}  // namespace sightline::testing_support

#define SL_SKIP_WITHOUT_CHROMIUM() \
  if (!sightline::testing_support::hasChromium()) GTEST_SKIP() << "no chromium"

#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <string>

#include "core/base/error.h"
#include "core/cli/commands.h"
#include "core/cli/help_format.h"
#include "core/cli/pocl_cache.h"
#include "core/cli/usage.h"

namespace sightline {
namespace {

/// One line, whatever the user's words hold: a control character shows as "?".
int fail(std::string line, int exit_code) {
  std::fflush(stdout);
  for (char& c : line) {
    if (std::iscntrl(uint8_t(c)) != 0) c = '?';
  }
  std::fprintf(stderr, "sightline: %s\n", line.c_str());
  return exit_code;
}

int runCommand(CLI::App& app, int argc, char** argv) {
  try {
    refuseSingleDashes(app, argc, argv);
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return fail(usageLine(app, error), kExitUsage);
  } catch (const ExitCode& exit_code) {
    return exit_code.code;
  } catch (const Error& error) {
    return fail(error.what(), error.exitCode());
  } catch (const std::bad_alloc&) {
    return fail("not enough memory for this; free some, or take a smaller scene", kExitFailed);
  } catch (const std::exception& error) {
    return fail(std::string("internal error: ") + error.what(), kExitFailed);
  }
}

/// What was printed must have arrived. Into a pipe it can fail only because the reader went away (| head),
/// which is no failure of ours.
int flushOutput(int exit_code) {
  struct stat target = {};
  const bool pipe =
      ::fstat(STDOUT_FILENO, &target) == 0 && !S_ISREG(target.st_mode) && !S_ISCHR(target.st_mode);
  const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (written || pipe || exit_code != 0) return exit_code;
  return fail("cannot write to standard output: is the disk full?", kExitFailed);
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  using namespace sightline;
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe must not end a bake
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes is an error of the write
  keepPoclCacheInUsersFolder();
  CLI::App app("Potentially visible sets of scenes by guided visibility sampling (GVS++)", "sightline");
  app.set_version_flag("--version", "sightline " SL_VERSION);
  app.require_subcommand(1);
  app.formatter(std::make_shared<HelpFormat>());
#define SL_COMMAND(function) function(app);
#include "generated/commands.inc"
#undef SL_COMMAND
  app.footer("sightline help COMMAND says all about one of them.");  // now: a command would take it over
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) command->group("Commands");
  refuseSlips(app);
  if (argc < 2) {
    std::fputs(app.help().c_str(), stderr);
    return kExitUsage;
  }
  return flushOutput(runCommand(app, argc, argv));
}

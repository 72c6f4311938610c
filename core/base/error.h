#pragma once
#include <stdexcept>
#include <string>

namespace sightline {

/// Exit codes of the command line (0: done).
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitPastLimit = 3;  ///< crosscheck, verify, measure, walk: past a given limit

/// What went wrong, as the one line that the user gets: file, place, what was expected, what to do.
/// Example: "city.obj:812: vertex index 99 is out of range 1..42". Control characters, which the names in a
/// foreign file may bring with them, become '_': no file commands the terminal.
class Error : public std::runtime_error {
 public:
  /// log: lines of a compiler that follow as they are.
  explicit Error(const std::string& line, int exit_code = kExitFailed, const std::string& log = {});
  /// Exit code that the command line returns for it.
  int exitCode() const { return exit_code_; }

 private:
  int exit_code_;
};

}  // namespace sightline

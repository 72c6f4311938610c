#include <fmt/core.h>

#include <array>
#include <filesystem>
#include <memory>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/number_checks.h"
#include "core/cli/text_outputs.h"
#include "core/diff/pvs_diff_report.h"
#include "core/io/file_io.h"
#include "core/pvs/pvs_writer.h"

namespace sightline {
namespace {

struct DiffCommand {
  std::filesystem::path a, b, report;
  uint64_t lines = 30;
};

std::string reportText(const DiffCommand& command, const PvsDiff& diff) {
  Json json = {{"sightline", SL_VERSION}, {"a", command.a.string()}, {"b", command.b.string()}};
  json.update(diffJson(diff));
  return jsonText(json);
}

void run(const DiffCommand& command) {
  requireSeparate(std::array{command.report}, std::array{command.a, command.b});
  const TextOutputs outputs({&command.report, 1});
  const PvsFile a = loadFinishedCells(command.a), b = loadFinishedCells(command.b);
  const PvsDiff diff = diffPvs(a, b);
  const std::vector<std::string> lines = diffLines(diff);
  const size_t shown = size_t(std::min<uint64_t>(lines.size(), command.lines));
  for (size_t i = 0; i < shown; ++i) fmt::print("{}\n", lines[i]);
  if (shown < lines.size()) fmt::print("... and {}\n", counted(lines.size() - shown, "more difference"));
  if (a.version != b.version) {
    fmt::print("formats: version {} in A, {} in B (no difference)\n", a.version, b.version);
  }
  fmt::print("{}\n", diffVerdict(diff));
  std::fflush(stdout);
  if (!command.report.empty()) outputs.save(reportText(command, diff), command.report);
  if (!diff.same()) throw ExitCode{kExitPastLimit};
}

constexpr const char* kFooter =
    "Exit code 0: the same, whatever the devices, the times and the number of stops;\n"
    "3: different; 1: a file cannot be read.\n\n"
    "Example:\n"
    "  sightline diff city.pvs quick.pvs --report - | grep same\n";

}  // namespace

void addDiffCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("diff", "Say whether two bakes are the same, and where not");
  const auto options = std::make_shared<DiffCommand>();
  command->add_option("a", options->a, "A: .pvs or .pvs.part")->required()->type_name("A.pvs");
  command->add_option("b", options->b, "B")->required()->type_name("B.pvs");
  command
      ->add_option("--report", options->report,
                   "write all differences as JSON (docs/report.md); - is standard output")
      ->type_name("R.json");
  command->add_option("--lines", options->lines, "show so many differences at most")
      ->transform(wholeNumber())
      ->type_name("N")
      ->capture_default_str();
  command->footer(kFooter);
  command->callback([options] { run(*options); });
}

}  // namespace sightline

#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "core/bake/cell_json.h"
#include "core/bake/report.h"
#include "core/crosscheck/crosscheck.h"

namespace sightline {

/// What a cross-check was run on, for its report.
struct CrosscheckHead {
  std::string version;  ///< of the program
  SceneSummary scene;
  double scale = 1, move = 0;  ///< how the scene was changed before
  CrosscheckOptions options;
  std::vector<std::string> cells;  ///< names
};

/// Largest counts that still pass, each of any one device over all kinds; none: any.
struct CrosscheckLimits {
  std::optional<uint64_t> wrong, missed, rounded, differences;
  std::optional<double> ulps;
};

/// What is past the limits: "opencl: 3 wrong, at most 0 allowed". Empty: nothing.
std::vector<std::string> pastLimits(const CrosscheckReport& report, const CrosscheckLimits& limits);

/// JSON as docs/report.md says, without the bakes' difference.
Json crosscheckJson(const CrosscheckHead& head, const CrosscheckReport& report);

/// A line a kind and device, and the worst rays that are not right.
std::string crosscheckTable(const CrosscheckReport& report);

}  // namespace sightline

#pragma once
// The methods that must draw all that has a pixel, each measure of CHC++ with and without.
#include <functional>

#include "core/draw/cull_methods.h"

namespace sightline::draw_cases {

struct MethodCase {
  std::string name;
  std::function<std::unique_ptr<CullMethod>(const DrawScene&, const Schedule&)> make;
};

inline std::vector<MethodCase> exactMethods() {
  std::vector<MethodCase> cases{
      {"none", [](const DrawScene& s, const Schedule&) { return cullNothing(s); }},
      {"vfc", [](const DrawScene& s, const Schedule&) { return cullFrustum(s); }},
      {"stop-and-wait", [](const DrawScene& s, const Schedule& t) { return cullStopAndWait(s, t); }},
      {"chc", [](const DrawScene& s, const Schedule& t) { return cullChc(s, t); }},
  };
  const auto add = [&](const std::string& name, const ChcOptions& options) {
    cases.push_back(
        {name, [options](const DrawScene& s, const Schedule& t) { return cullChcPlus(s, options, t); }});
  };
  add("chc++", plainChc());
  add("opti-chc++", {});
  add("batch of 1", {.batch_size = 1});
  add("batch of 7, assumed 0", {.batch_size = 7, .assumed_frames = 0});
  add("assumed 20", {.assumed_frames = 20});
  add("no multiqueries", {.multi_queries = false});
  add("no tight bounds", {.tight_bounds = false});
  add("no c-queue", {.c_queue = false});
  add("no batching", {.batching = false});
  add("no second condition", {.late_issue = false});
  add("chc++, assumed 0, no tight bounds",
      {.assumed_frames = 0, .tight_bounds = false, .c_queue = false, .batching = false, .late_issue = false});
  return cases;
}

}  // namespace sightline::draw_cases

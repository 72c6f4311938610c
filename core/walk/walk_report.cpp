#include "core/walk/walk_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/bake/report_json.h"
#include "core/base/text.h"
#include "core/io/csv.h"

namespace sightline {
namespace {

/// Share of unexplained pixels from which on they are worth a word: surfaces in one place give fewer.
constexpr double kManyUnexplained = 1e-3;

/// Mean of the `share` greatest of values, ascending; at least of one.
double meanOfGreatest(const std::vector<double>& values, double share) {
  const size_t count = std::max<size_t>(1, size_t(double(values.size()) * share));
  double sum = 0;
  for (size_t i = values.size() - count; i < values.size(); ++i) sum += values[i];
  return sum / double(count);
}

/// The value, or null where nothing was measured.
Json known(bool any, double value) {
  return any ? Json(value) : Json();
}

Json countsJson(const WalkSummary& s) {
  const bool any = s.counted > 0;
  return {{"objects", known(any, s.objects)}, {"triangles", known(any, s.triangles)},
          {"queries", known(any, s.queries)}, {"submits", known(any, s.submits)},
          {"waits", known(any, s.waits)},     {"frames_outside", any ? Json(s.outside) : Json()}};
}

Json timesJson(const WalkSummary& s) {
  const bool any = s.timed > 0;
  return {{"mean_ms", known(any, s.mean)},
          {"median_ms", known(any, s.median)},
          {"slowest_1_percent_ms", known(any, s.slowest_1)},
          {"slowest_01_percent_ms", known(any, s.slowest_01)},
          {"gpu_ms", known(s.gpu_timed > 0, s.gpu)},
          {"cpu_ms", known(any, s.cpu)}};
}

Json methodJson(const WalkReport& report, const MethodReplay& method) {
  const WalkSummary all = summarize(method, 0, method.times.size());
  Json json = {{"name", method.name},
               {"repeats", method.repeats},
               {"warm_up", method.warm_up},
               {"frames", method.times.size()}};
  json.update(timesJson(all));
  json.update(countsJson(all));
  if (!method.checks.empty()) {
    Json pops = Json::array();
    for (const Pop& p : method.pops) {
      pops.push_back({{"drawable", p.drawable},
                      {"first_frame", p.first_frame},
                      {"frames", p.frames},
                      {"most_pixels", p.most_pixels}});
    }
    const WalkSummary checked = summarize(method, 0, method.checks.size());
    json["check"] = {{"frames", method.checks.size()},
                     {"false_pixels", checked.false_pixels},
                     {"frames_with_false", checked.false_frames},
                     {"most_false_pixels", checked.most_false},
                     {"largest_region", checked.largest_region},
                     {"behind_alpha", checked.behind_alpha},
                     {"near_pixels", checked.near_pixels},
                     {"times_missing", method.pop_count},
                     {"longest_missing", pops}};
  }
  Json stretches = Json::array();
  for (const WalkStretch& stretch : stretchesOf(report.frames)) {
    if (stretch.begin >= method.times.size()) break;
    const WalkSummary s = summarize(method, stretch.begin, stretch.end);
    Json one = {{"first_frame", stretch.begin}, {"end_frame", stretch.end}};
    one.update(timesJson(s));
    one.update(countsJson(s));
    stretches.push_back(one);
  }
  json["stretches"] = stretches;
  return json;
}

Json optionsJson(const WalkReport& report) {
  const ReplayOptions& o = report.options;
  const ChcOptions& chc = o.method.chc;
  return {{"repeats", o.repeats},
          {"in_flight", o.in_flight},
          {"schedule", o.method.schedule.fixed ? "fixed" : "live"},
          {"seed", o.method.schedule.seed},
          {"chain", report.chain},
          {"batch", chc.batch_size},
          {"assume", chc.assumed_frames},
          {"multi_queries", chc.multi_queries},
          {"tight_bounds", chc.tight_bounds},
          {"c_queue", chc.c_queue},
          {"batching", chc.batching},
          {"second_condition", chc.late_issue},
          {"outside", o.method.cells.outside == OutsideCells::all       ? "all"
                      : o.method.cells.outside == OutsideCells::nearest ? "nearest"
                                                                        : "error"}};
}

/// What the set of each cell is worth at views out of it.
Json cellsJson(const WalkReport& report) {
  Json cells = Json::array();
  for (const CellStretch& stretch : cellStretchesOf(report.frames)) {
    const WalkedCell& cell = report.cells[stretch.cell];
    Json methods = Json::object();
    for (const MethodReplay& m : report.replay.methods) {
      const WalkSummary s = summarize(m, stretch.frames.begin, stretch.frames.end);
      Json one = timesJson(s);
      one.update(countsJson(s));
      if (s.checked > 0) one["false_pixels"] = s.false_pixels;
      methods[m.name] = one;
    }
    cells.push_back(
        {{"name", cell.name},
         {"triangles", cell.triangles},
         {"share", double(cell.triangles) / double(std::max<uint64_t>(report.scene.triangles, 1))},
         {"first_frame", stretch.frames.begin},
         {"end_frame", stretch.frames.end},
         {"methods", methods}});
  }
  return cells;
}

Json tracedJson(const WalkReplay& replay) {
  Json traced = Json::array();
  for (const TracedFrame& t : replay.traced) {
    traced.push_back({{"frame", t.frame},
                      {"ms", t.milliseconds},
                      {"objects", t.drawables},
                      {"triangles", t.triangles},
                      {"object_triangles", t.drawable_triangles},
                      {"other_pixels", t.other_pixels},
                      {"unexplained_pixels", t.unexplained_pixels}});
  }
  return traced;
}

std::string falseText(const MethodReplay& method, const WalkSummary& s) {
  return method.checks.empty() ? "-" : std::to_string(s.false_pixels);
}

}  // namespace

WalkSummary summarize(const MethodReplay& method, size_t begin, size_t end) {
  WalkSummary s;
  end = std::min(end, std::max(method.times.size(), method.checks.size()));
  std::vector<double> frames;
  for (size_t i = begin; i < std::min(end, method.times.size()); ++i) {
    const FrameTimes& t = method.times[i];
    frames.push_back(t.frame);
    s.gpu += t.gpu_frame;
    s.gpu_timed += t.gpu_frame > 0 ? 1 : 0;
    for (const CpuPart part : {CpuPart::traverse, CpuPart::record, CpuPart::submit})
      s.cpu += t.cpu[size_t(part)];
  }
  s.timed = frames.size();
  if (!frames.empty()) {
    std::ranges::sort(frames);
    const size_t middle = frames.size() / 2;
    s.median = frames.size() % 2 == 1 ? frames[middle] : (frames[middle - 1] + frames[middle]) / 2;
    s.mean = meanOfGreatest(frames, 1);
    s.slowest_1 = meanOfGreatest(frames, 0.01);
    s.slowest_01 = meanOfGreatest(frames, 0.001);
    s.gpu /= double(std::max<uint64_t>(s.gpu_timed, 1));
    s.cpu /= double(frames.size());
  }
  for (size_t i = begin; i < std::min(end, method.counts.size()); ++i, ++s.counted) {
    const FrameCounts& c = method.counts[i];
    s.objects += double(c.objects);
    s.triangles += double(c.triangles);
    s.queries += double(c.queries);
    s.submits += double(c.submits);
    s.waits += double(c.waits);
    s.outside += c.outside ? 1 : 0;
  }
  for (double* mean : {&s.objects, &s.triangles, &s.queries, &s.submits, &s.waits}) {
    *mean /= double(std::max<uint64_t>(s.counted, 1));
  }
  for (size_t i = begin; i < std::min(end, method.checks.size()); ++i) {
    const CheckedFrame& c = method.checks[i];
    ++s.checked;
    s.false_pixels += c.false_pixels;
    s.near_pixels += c.near_pixels;
    s.false_frames += c.false_pixels > 0 ? 1 : 0;
    s.most_false = std::max(s.most_false, c.false_pixels);
    s.largest_region = std::max(s.largest_region, c.largest_region);
    s.behind_alpha += c.behind_alpha;
  }
  return s;
}

std::vector<WalkStretch> stretchesOf(const WalkFrames& frames) {
  std::vector<WalkStretch> stretches;
  uint32_t begin = 0;
  for (const uint32_t cut : frames.cuts) {
    stretches.push_back({begin, cut});
    begin = cut;
  }
  stretches.push_back({begin, uint32_t(frames.cameras.size())});
  return stretches;
}

std::vector<CellStretch> cellStretchesOf(const WalkFrames& frames) {
  std::vector<CellStretch> stretches;
  for (uint32_t frame = 0; frame < frames.cells.size(); ++frame) {
    if (stretches.empty() || stretches.back().cell != frames.cells[frame]) {
      stretches.push_back({frames.cells[frame], {frame, frame}});
    }
    ++stretches.back().frames.end;
  }
  return stretches;
}

std::vector<std::string> leftOutLines(const WalkReport& report) {
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
  for (const LeftOutMethod& m : report.left_out) {
    const auto found =
        std::ranges::find(reasons, m.why, &std::pair<std::string, std::vector<std::string>>::first);
    if (found == reasons.end()) {
      reasons.push_back({m.why, {m.name}});
    } else {
      found->second.push_back(m.name);
    }
  }
  std::vector<std::string> lines;
  for (const auto& [why, names] : reasons) {
    lines.push_back(
        fmt::format("{} {} left out: {}", fmt::join(names, ", "), names.size() == 1 ? "is" : "are", why));
  }
  return lines;
}

std::vector<std::string> walkNotes(const WalkReport& report) {
  std::vector<std::string> notes, warm;
  for (const MethodReplay& m : report.replay.methods) {
    if (m.warm_up) warm.push_back(m.name);
  }
  if (!warm.empty()) {
    notes.push_back(fmt::format("times of {} are of the warm-up: the walk was stopped before a repeat",
                                fmt::join(warm, ", ")));
  }
  uint64_t unexplained = 0;
  for (const TracedFrame& t : report.replay.traced) unexplained += t.unexplained_pixels;
  const double pixels = double(report.width) * report.height * double(report.replay.traced.size());
  if (double(unexplained) > kManyUnexplained * pixels) {
    notes.push_back(
        fmt::format("{} of the {} pixels of traced frames show what no ray within 1/128 pixel meets: this "
                    "device draws very "
                    "narrow triangles where they are not, and false pixels may be of that kind "
                    "(docs/walk.md, Where it ends)",
                    unexplained, uint64_t(pixels)));
  }
  return notes;
}

std::string walkTable(const WalkReport& report) {
  std::string table = fmt::format("{:<14} {:>9} {:>9} {:>9} {:>8} {:>9} {:>10} {:>8} {:>8} {:>8} {:>12}\n",
                                  "method", "ms", "slow 1 %", "0.1 %", "gpu ms", "objects", "triangles",
                                  "queries", "submits", "waits", "false pixels");
  for (const MethodReplay& m : report.replay.methods) {
    if (m.times.empty()) {
      table += fmt::format("{:<14} {:>9}\n", m.name, "not run");
      continue;
    }
    const WalkSummary s = summarize(m, 0, report.frames.cameras.size());
    table += fmt::format(
        "{:<14} {:>9.3f} {:>9.3f} {:>9.3f} {:>8} {:>9.1f} {:>10} {:>8.1f} {:>8.1f} {:>8.1f} {:>12}\n", m.name,
        s.mean, s.slowest_1, s.slowest_01, s.gpu_timed > 0 ? fmt::format("{:.3f}", s.gpu) : "-", s.objects,
        shortCount(uint64_t(s.triangles + 0.5)), s.queries, s.submits, s.waits, falseText(m, s));
  }
  if (!report.replay.traced.empty()) {
    double ms = 0, objects = 0, triangles = 0;
    for (const TracedFrame& t : report.replay.traced) {
      ms += t.milliseconds, objects += double(t.drawables), triangles += double(t.triangles);
    }
    const double n = double(report.replay.traced.size());
    table += fmt::format("{:<14} {:>9.3f} {:>9} {:>9} {:>8} {:>9.1f} {:>10}   ({} frames, {})\n", "traced",
                         ms / n, "-", "-", "-", objects / n, shortCount(uint64_t(triangles / n + 0.5)),
                         report.replay.traced.size(), report.tracer);
  }
  return table;
}

Json walkJson(const WalkReport& report) {
  Json methods = Json::array(), left_out = Json::array();
  for (const MethodReplay& m : report.replay.methods) methods.push_back(methodJson(report, m));
  for (const LeftOutMethod& m : report.left_out) left_out.push_back({{"name", m.name}, {"why", m.why}});
  return {
      {"sightline", report.version},
      {"complete", report.replay.complete},
      {"problem", report.replay.problem},
      {"scene",
       {{"name", report.scene.name},
        {"hash", hashText(report.scene.hash)},
        {"triangles", report.scene.triangles},
        {"drawables", report.drawables},
        {"split", report.split}}},
      {"device", {{"id", report.device.id}, {"name", report.device.name}, {"driver", report.device.driver}}},
      {"tracer", report.tracer},
      {"path", report.path},
      {"pvs", report.pvs},
      {"frames", report.frames.cameras.size()},
      {"cuts", report.frames.cuts},
      {"width", report.width},
      {"height", report.height},
      {"fov", report.fov},
      {"options", optionsJson(report)},
      {"seconds", report.replay.seconds},
      {"methods", methods},
      {"cells", cellsJson(report)},
      {"left_out", left_out},
      {"traced", tracedJson(report.replay)}};
}

std::string walkCsv(const WalkReport& report) {
  std::vector<std::string> columns = {"method", "frame", "frame_ms", "gpu_ms"};
  for (const char* part : {"traverse", "record", "submit", "wait_queries", "wait_frames"}) {
    columns.push_back(fmt::format("cpu_{}_ms", part));
  }
  for (const char* part : kGpuPartNames) columns.push_back(fmt::format("gpu_{}_ms", part));
  for (const char* name :
       {"submits",         "draws",           "objects",           "triangles",      "queries",
        "multi_queries",   "failed_queries",  "retest_queries",    "query_boxes",    "node_visits",
        "waits",           "outside",         "false_pixels",      "near_pixels",    "largest_false",
        "missing_objects", "optimal_objects", "optimal_triangles", "largest_region", "behind_alpha"}) {
    columns.emplace_back(name);
  }
  Csv csv(columns);
  for (const MethodReplay& m : report.replay.methods) {
    const size_t frames = std::max({m.times.size(), m.counts.size(), m.checks.size()});
    for (size_t i = 0; i < frames; ++i) {
      std::vector<std::string> row = {m.name, std::to_string(i)};
      const auto number = [&](bool known, double value) {
        row.push_back(known ? fmt::format("{}", value) : "");
      };
      const auto count = [&](bool known, uint64_t value) {
        row.push_back(known ? std::to_string(value) : "");
      };
      const bool timed = i < m.times.size(), counted = i < m.counts.size(), checked = i < m.checks.size();
      const FrameTimes t = timed ? m.times[i] : FrameTimes{};
      number(timed, t.frame);
      number(t.gpu_frame > 0, t.gpu_frame);
      for (const double part : t.cpu) number(timed, part);
      for (const double part : t.gpu) number(t.gpu_frame > 0, part);
      const FrameCounts c = counted ? m.counts[i] : FrameCounts{};
      for (const uint64_t value :
           {c.submits, c.draws, c.objects, c.triangles, c.queries, c.multi_queries, c.failed_queries,
            c.retest_queries, c.query_boxes, c.node_visits, c.waits, uint64_t(c.outside)}) {
        count(counted, value);
      }
      const CheckedFrame k = checked ? m.checks[i] : CheckedFrame{};
      for (const uint64_t value : {k.false_pixels, k.near_pixels, k.largest, k.missing, k.optimal_drawables,
                                   k.optimal_triangles, k.largest_region, k.behind_alpha}) {
        count(checked, value);
      }
      csv.row(row);
    }
  }
  return csv.text();
}

std::vector<std::string> pastFalse(const WalkReport& report, uint64_t max_false) {
  std::vector<std::string> lines;
  for (const MethodReplay& m : report.replay.methods) {
    if (!walkMethod(m.name).exact) continue;
    const WalkSummary s = summarize(m, 0, m.checks.size());
    if (s.false_pixels > max_false) {
      const auto worst = std::ranges::max_element(m.checks, {}, &CheckedFrame::false_pixels);
      lines.push_back(fmt::format("{}: {} false pixels in {}, at most {} allowed; most in frame {}", m.name,
                                  s.false_pixels, counted(s.false_frames, "frame"), max_false,
                                  worst - m.checks.begin()));
    }
    if (s.near_pixels > 0) {
      lines.push_back(
          fmt::format("{}: {} pixels are nearer than with everything drawn: the device draws the same "
                      "triangles in two ways",
                      m.name, s.near_pixels));
    }
  }
  return lines;
}

}  // namespace sightline

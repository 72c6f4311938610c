#include "core/walk/walk_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/base/text.h"

namespace sightline {
namespace {

constexpr size_t kPointsALine = 240;          // of a chart over frames
constexpr double kThinnestSpan = 1.0 / 4000;  // of a span chart: less is no pixel wide

const MethodReplay* methodOf(const WalkReport& report, std::string_view name) {
  for (const MethodReplay& m : report.replay.methods) {
    if (m.name == name && !m.times.empty()) return &m;
  }
  return nullptr;
}

/// The method whose parts are drawn: what the thesis is about, else the last that asks queries, else any.
const MethodReplay* mainMethod(const WalkReport& report) {
  for (const char* name :
       {"opti-chc++", "chc++", "chc", "stop-and-wait", "hiz", "pvs+hiz", "pvs+vfc", "vfc"}) {
    if (const MethodReplay* m = methodOf(report, name)) return m;
  }
  for (const MethodReplay& m : report.replay.methods) {
    if (!m.times.empty()) return &m;
  }
  return nullptr;
}

/// By the method's place among those that were replayed, so that few methods have colours of their own.
uint32_t colorOf(const WalkReport& report, const MethodReplay& method) {
  return uint32_t(&method - report.replay.methods.data());
}

size_t framesAPoint(size_t frames) {
  return std::max<size_t>(1, (frames + kPointsALine - 1) / kPointsALine);
}

enum class Of { mean, most };

/// A number of each frame as a line; where there are many, the mean or most of some frames a point.
template <typename Number>
std::vector<ChartPoint> overFrames(size_t frames, Of of, Number&& number) {
  const size_t step = framesAPoint(frames);
  std::vector<ChartPoint> points;
  for (size_t begin = 0; begin < frames; begin += step) {
    const size_t end = std::min(frames, begin + step);
    double sum = 0, most = 0;
    for (size_t i = begin; i < end; ++i) {
      const double value = number(i);
      sum += value;
      most = std::max(most, value);
    }
    points.push_back({double(begin), of == Of::mean ? sum / double(end - begin) : most});
  }
  return points;
}

std::string pointNote(const WalkReport& report, Of of) {
  const size_t step = framesAPoint(report.frames.cameras.size());
  if (step == 1) return "";
  return fmt::format("Each point is the {} of {} frames.", of == Of::mean ? "mean" : "slowest", step);
}

std::string cutsNote(const WalkReport& report) {
  const std::vector<uint32_t>& cuts = report.frames.cuts;
  if (cuts.empty() || cuts.size() > 6) return "";
  return fmt::format(" The camera jumps at frame{} {}.", cuts.size() == 1 ? "" : "s", fmt::join(cuts, ", "));
}

/// "1.23", three digits.
std::string digits(double value) {
  if (value == 0) return "0";
  if (value < 1e-3) return fmt::format("{:.2g}", value);
  const int decimals = value < 1 ? 3 : value < 10 ? 2 : value < 100 ? 1 : 0;
  return fmt::format("{:.{}f}", value, decimals);
}

std::string times(double slow, double fast) {
  return fast > 0 && slow > 0 ? digits(slow / fast) + " x" : "-";
}

ReportTable methodsTable(const WalkReport& report) {
  ReportTable table{
      .columns = {"method", "ms a frame", "frames/s", "1 % low", "0.1 % low", "against vfc", "GPU ms",
                  "objects", "triangles", "queries", "submits", "false pixels", "longest missing"},
      .short_names = true};
  const MethodReplay* vfc = methodOf(report, "vfc");
  const double vfc_ms = vfc == nullptr ? 0 : summarize(*vfc, 0, vfc->times.size()).mean;
  for (const MethodReplay& m : report.replay.methods) {
    if (m.times.empty()) {
      std::vector<std::string> row(table.columns.size(), "-");
      row[0] = m.name;
      row[1] = "not run";
      table.rows.push_back(row);
      continue;
    }
    const WalkSummary s = summarize(m, 0, std::max(m.times.size(), m.checks.size()));
    const bool checked = !m.checks.empty();
    table.rows.push_back({m.name, digits(s.mean), digits(1000 / s.mean), digits(1000 / s.slowest_1),
                          digits(1000 / s.slowest_01), times(vfc_ms, s.mean),
                          s.gpu_timed > 0 ? digits(s.gpu) : "-", digits(s.objects),
                          shortCount(uint64_t(s.triangles + 0.5)), digits(s.queries), digits(s.submits),
                          checked ? std::to_string(s.false_pixels) : "-",
                          !checked         ? "-"
                          : m.pops.empty() ? "0"
                                           : counted(m.pops.front().frames, "frame")});
  }
  const std::vector<TracedFrame>& traced = report.replay.traced;
  if (!traced.empty()) {
    const auto mean = [&](auto&& number) {
      double sum = 0;
      for (const TracedFrame& t : traced) sum += double(number(t));
      return sum / double(traced.size());
    };
    const double ms = mean([](const TracedFrame& t) { return t.milliseconds; });
    table.rows.push_back({"traced", digits(ms), digits(1000 / ms), "-", "-", times(vfc_ms, ms), "-",
                          digits(mean([](const TracedFrame& t) { return t.drawables; })),
                          shortCount(uint64_t(mean([](const TracedFrame& t) { return t.triangles; }) + 0.5)),
                          "-", "-", "-", "-"});
  }
  return table;
}

/// Mean milliseconds in each stretch between cuts.
ReportTable stretchTable(const WalkReport& report, const std::vector<WalkStretch>& stretches) {
  ReportTable table{
      .caption = "Milliseconds a frame between cuts", .columns = {"method"}, .short_names = true};
  for (const WalkStretch& s : stretches) {
    table.columns.push_back(fmt::format("frames {} to {}", s.begin, s.end - 1));
  }
  for (const MethodReplay& m : report.replay.methods) {
    if (m.times.empty()) continue;
    std::vector<std::string> row = {m.name};
    for (const WalkStretch& s : stretches) {
      row.push_back(s.begin < m.times.size() ? digits(summarize(m, s.begin, s.end).mean) : "-");
    }
    table.rows.push_back(row);
  }
  return table;
}

/// A number of each frame of all methods that `shows`, a line each.
template <typename Shows, typename Number>
ReportChart methodsChart(const WalkReport& report, ReportChart chart, Of of, Shows&& shows, Number&& number) {
  for (const MethodReplay& m : report.replay.methods) {
    if (!shows(m)) continue;
    const size_t frames = std::min(m.times.size(), std::max(m.counts.size(), size_t(0)));
    if (frames == 0) continue;
    chart.series.push_back({.name = m.name,
                            .points = overFrames(frames, of, [&](size_t i) { return number(m, i); }),
                            .color = colorOf(report, m)});
  }
  return chart;
}

bool asksQueries(const MethodReplay& m) {
  return std::ranges::any_of(m.counts, [](const FrameCounts& c) { return c.queries > 0; });
}

template <size_t kParts>
ReportChart partsChart(const WalkReport& report, const MethodReplay& m, const std::string& title,
                       const std::array<const char*, kParts>& names,
                       std::array<double, kParts> FrameTimes::*parts) {
  ReportChart chart{.title = title,
                    .note = fmt::format("{}. {}", m.name, pointNote(report, Of::mean)),
                    .x = "frame",
                    .y = "ms",
                    .stacked = true};
  for (size_t part = 0; part < kParts; ++part) {
    const auto points = overFrames(m.times.size(), Of::mean,
                                   [&](size_t i) { return std::max(0.0, (m.times[i].*parts)[part]); });
    const bool any = std::ranges::any_of(points, [](const ChartPoint& p) { return p.y > 0; });
    if (any) chart.series.push_back({.name = names[part], .points = points, .color = uint32_t(part)});
  }
  return chart;
}

void addTimes(HtmlReport& page, const WalkReport& report) {
  page.section("Time a frame");
  const auto all = [](const MethodReplay&) { return true; };
  page.charts({methodsChart(
      report,
      {.title = "Frame time by method",
       .note = fmt::format("Medians of {}. {}{}", counted(report.options.repeats, "whole replay"),
                           pointNote(report, Of::most), cutsNote(report)),
       .x = "frame",
       .y = "ms",
       .log_y = true},
      Of::most, all, [](const MethodReplay& m, size_t i) { return m.times[i].frame; })});
}

std::string slowestTitle(const MethodReplay& m, size_t frame, double ms) {
  return fmt::format("The slowest frame of {}: {}, {} ms", m.name, frame, digits(ms));
}

/// What happened when in the slowest frame of all repeats.
ReportSpans spansOf(const MethodReplay& m) {
  const SlowestFrame& slowest = m.slowest;
  double end = 0;
  for (const auto& span : slowest.spans.cpu) end = std::max(end, span.end);
  for (const auto& span : slowest.spans.gpu) end = std::max(end, span.end);
  ReportSpans spans{
      .title = slowestTitle(m, slowest.frame, slowest.milliseconds),
      .note = fmt::format("Of all repeats. The GPU's clock is another: its first command is put where "
                          "the first submit begins, and may start later. Spans below {} ms are left out.",
                          digits(end * kThinnestSpan)),
      .unit = "ms",
      .rows = {{"processor", {}}, {"GPU", {}}}};
  const auto add = [&](std::vector<ReportSpan>& row, const char* name, double begin, double until) {
    if (until - begin >= end * kThinnestSpan) row.push_back({name, begin, until});
  };
  for (const auto& span : slowest.spans.cpu) {
    add(spans.rows[0].second, kCpuPartNames[size_t(span.part)], span.begin, span.end);
  }
  for (const auto& span : slowest.spans.gpu)
    add(spans.rows[1].second, kGpuPartNames[span.part], span.begin, span.end);
  return spans;
}

/// Where nobody knows when: how much of the slowest frame each part takes.
ReportSpans partsInARow(const WalkReport& report, const MethodReplay& m) {
  const auto worst = std::ranges::max_element(m.times, {}, &FrameTimes::frame);
  ReportSpans spans{
      .title = slowestTitle(m, size_t(worst - m.times.begin()), worst->frame),
      .note = "How much of it each part takes, put in a row: parts alternate many times in a frame.",
      .unit = "ms",
      .rows = {}};
  const auto row = [&](const std::string& name, const auto& names, const auto& parts) {
    std::vector<ReportSpan> bars;
    double at = 0;
    for (size_t i = 0; i < parts.size(); ++i) {
      if (!(parts[i] > 0)) continue;
      bars.push_back({names[i], at, at + parts[i]});
      at += parts[i];
    }
    spans.rows.emplace_back(name, bars);
  };
  row("processor", kCpuPartNames, worst->cpu);
  if (report.gpu_times) row("GPU", kGpuPartNames, worst->gpu);
  return spans;
}

void addParts(HtmlReport& page, const WalkReport& report) {
  const MethodReplay* m = mainMethod(report);
  if (m == nullptr) return;
  page.section("Where the time goes");
  std::vector<ReportChart> charts;
  if (report.gpu_times) {
    charts.push_back(partsChart(report, *m, "GPU time by part", kGpuPartNames, &FrameTimes::gpu));
  }
  charts.push_back(partsChart(report, *m, "Processor time by part", kCpuPartNames, &FrameTimes::cpu));
  page.charts(charts);
  page.spans(m->slowest.spans.empty() ? partsInARow(report, *m) : spansOf(*m));
}

void addQueries(HtmlReport& page, const WalkReport& report) {
  if (std::ranges::none_of(report.replay.methods, asksQueries)) return;
  page.section("Queries and submits");
  page.charts(
      {methodsChart(
           report,
           {.title = "Queries a frame", .note = pointNote(report, Of::mean), .x = "frame", .y = "queries"},
           Of::mean, asksQueries,
           [](const MethodReplay& m, size_t i) { return double(m.counts[i].queries); }),
       methodsChart(
           report,
           {.title = "Submits a frame", .note = pointNote(report, Of::mean), .x = "frame", .y = "submits"},
           Of::mean, asksQueries,
           [](const MethodReplay& m, size_t i) { return double(m.counts[i].submits); })});
}

/// Triangles or objects a frame, against the fewest possible.
ReportChart drawnChart(const WalkReport& report, const std::string& title, const std::string& y,
                       uint64_t FrameCounts::*drawn, uint64_t CheckedFrame::*optimal) {
  constexpr uint32_t kOptimalColor = 6;
  ReportChart chart = methodsChart(
      report, {.title = title, .note = pointNote(report, Of::mean), .x = "frame", .y = y, .log_y = true},
      Of::mean, [](const MethodReplay& m) { return m.name != "none" && m.name != "hiz-meshlets"; },
      [&](const MethodReplay& m, size_t i) { return double(m.counts[i].*drawn); });
  const MethodReplay* checked = nullptr;
  for (const MethodReplay& m : report.replay.methods) {
    if (!m.checks.empty() && (checked == nullptr || m.checks.size() > checked->checks.size())) checked = &m;
  }
  if (checked != nullptr) {
    chart.series.push_back(
        {.name = "optimal",
         .points = overFrames(checked->checks.size(), Of::mean,
                              [&](size_t i) { return double(checked->checks[i].*optimal); }),
         .dashed = true,
         .color = kOptimalColor});
  }
  return chart;
}

void addDrawn(HtmlReport& page, const WalkReport& report) {
  page.section("What is drawn");
  ReportChart triangles = drawnChart(report, "Triangles a frame", "triangles", &FrameCounts::triangles,
                                     &CheckedFrame::optimal_triangles);
  if (!report.replay.traced.empty()) {
    ChartSeries seen{.name = "triangles with a pixel, traced", .dots = true, .color = 9};
    const size_t step = (report.replay.traced.size() + 29) / 30;
    for (size_t i = 0; i < report.replay.traced.size(); i += step) {
      seen.points.push_back(
          {double(report.replay.traced[i].frame), double(report.replay.traced[i].triangles)});
    }
    triangles.series.push_back(seen);
  }
  page.charts({triangles, drawnChart(report, "Objects a frame", "objects", &FrameCounts::objects,
                                     &CheckedFrame::optimal_drawables)});
  page.text(
      "Optimal: the objects, parts of at most so many triangles, that have a pixel, and all of their "
      "triangles. No "
      "method that draws objects whole can draw less.");
}

/// Tables 7.5 and 8.1: what a set is worth.
void addSetTable(HtmlReport& page, const WalkReport& report) {
  ReportTable table{.columns = {"with", "without", "ms without", "ms with", "factor", "triangles drawn",
                                "share", "factor x share", "frames outside"},
                    .text_columns = 2,
                    .short_names = true};
  for (const auto& [with, without] : {std::pair("pvs", "none"), {"pvs+vfc", "vfc"}, {"pvs+hiz", "hiz"}}) {
    const MethodReplay *a = methodOf(report, with), *b = methodOf(report, without);
    if (a == nullptr || b == nullptr) continue;
    const WalkSummary fast = summarize(*a, 0, a->times.size()), slow = summarize(*b, 0, b->times.size());
    const double share = slow.triangles > 0 ? fast.triangles / slow.triangles : 0;
    table.rows.push_back({with, without, digits(slow.mean), digits(fast.mean), times(slow.mean, fast.mean),
                          shortCount(uint64_t(fast.triangles + 0.5)),
                          fmt::format("{} %", digits(100 * share)),
                          fast.mean > 0 ? fmt::format("{:.0f} %", 100 * slow.mean / fast.mean * share) : "-",
                          std::to_string(fast.outside)});
  }
  if (table.rows.empty()) return;
  page.section("What the set is worth");
  page.table(table);
  page.text(
      "A device whose time is all for triangles would be faster by 1 / share: the last column but one says "
      "how much of "
      "that is reached.");
}

/// Table 8.1: sets of small cells against those of large ones.
void addCellTable(HtmlReport& page, const WalkReport& report) {
  const std::vector<CellStretch> stretches = cellStretchesOf(report.frames);
  if (stretches.empty()) return;
  ReportTable table{.columns = {"cell", "triangles", "share"}};
  std::vector<const MethodReplay*> methods;
  for (const MethodReplay& m : report.replay.methods) {
    if (m.times.empty()) continue;
    methods.push_back(&m);
    table.columns.push_back(m.name + ", ms");
  }
  const MethodReplay *none = methodOf(report, "none"), *pvs = methodOf(report, "pvs");
  const bool both = none != nullptr && pvs != nullptr;
  if (both) table.columns.insert(table.columns.end(), {"pvs against none", "factor x share"});
  if (pvs != nullptr && !pvs->checks.empty()) table.columns.push_back("wrong share of pvs");
  const double pixels = double(report.width) * report.height;
  for (const CellStretch& stretch : stretches) {
    const WalkedCell& cell = report.cells[stretch.cell];
    const double share = double(cell.triangles) / double(std::max<uint64_t>(report.scene.triangles, 1));
    std::vector<std::string> row = {cell.name, std::to_string(cell.triangles),
                                    fmt::format("{} %", digits(100 * share))};
    const auto of = [&](const MethodReplay& m) {
      return summarize(m, stretch.frames.begin, stretch.frames.end);
    };
    for (const MethodReplay* m : methods) {
      const WalkSummary s = of(*m);
      row.push_back(s.timed > 0 ? digits(s.mean) : "-");
    }
    if (both) {
      const double slow = of(*none).mean, fast = of(*pvs).mean;
      row.push_back(times(slow, fast));
      row.push_back(fast > 0 && slow > 0 ? fmt::format("{:.0f} %", 100 * slow / fast * share) : "-");
    }
    if (pvs != nullptr && !pvs->checks.empty()) {
      const WalkSummary s = of(*pvs);
      row.push_back(s.checked > 0
                        ? fmt::format("{:.3g} %", 100 * double(s.false_pixels) / (pixels * double(s.checked)))
                        : "-");
    }
    table.rows.push_back(row);
  }
  page.section("What the set of each cell is worth");
  page.table(table);
  page.text(
      "Views out of each cell, drawn by its own set: what smaller cells gain, and what larger ones lose.");
}

void addWrong(HtmlReport& page, const WalkReport& report, const WalkPictures& pictures) {
  ReportTable table{
      .columns = {"method", "false pixels", "of all pixels", "frames with any", "most in a frame",
                  "largest region", "objects went missing", "longest", "of object", "from frame"},
      .short_names = true};
  if (report.replay.alpha) table.columns.emplace_back("behind holes or glass");
  const double pixels = double(report.width) * report.height;
  bool any = false;
  for (const MethodReplay& m : report.replay.methods) {
    if (m.checks.empty()) continue;
    any = true;
    const WalkSummary s = summarize(m, 0, m.checks.size());
    const bool popped = !m.pops.empty();
    table.rows.push_back(
        {m.name, std::to_string(s.false_pixels),
         fmt::format("{:.3g} %", 100 * double(s.false_pixels) / (pixels * double(m.checks.size()))),
         std::to_string(s.false_frames), std::to_string(s.most_false), std::to_string(s.largest_region),
         counted(m.pop_count, "time"), popped ? counted(m.pops.front().frames, "frame") : "-",
         popped ? std::to_string(m.pops.front().drawable) : "-",
         popped ? std::to_string(m.pops.front().first_frame) : "-"});
    if (report.replay.alpha) table.rows.back().push_back(std::to_string(s.behind_alpha));
  }
  if (!any) return;
  page.section("What is wrong");
  page.text(
      "Every frame's depth is compared, bit by bit, with that of a frame in which everything is drawn: a "
      "pixel is "
      "false if it shows something farther away. An object is missing for as many frames in a row as it has "
      "false "
      "pixels. A region is of pixels that touch each other, at corners too.");
  page.table(table);
  if (report.replay.alpha) {
    page.text(
        "Behind holes or glass: false pixels in front of which the ray meets a surface that one sees "
        "through. A set "
        "is wrong there where its bake took such surfaces for solid.");
  }
  uint64_t other = 0, unexplained = 0;
  for (const TracedFrame& t : report.replay.traced)
    other += t.other_pixels, unexplained += t.unexplained_pixels;
  if (!report.replay.traced.empty()) {
    page.text(fmt::format(
        "{} traced frames, {} pixels each: {} show another object than the one drawn there, {} of them "
        "farther than "
        "1/128 pixel from where tracing finds the one drawn (surfaces in the same place are among them).",
        report.replay.traced.size(), uint64_t(pixels), other, unexplained));
  }
  if (pictures.wrong.empty()) return;
  page.text("The worst frames: the scene grey, false pixels red.");
  page.pictures(pictures.wrong);
}

std::string introText(const WalkReport& report) {
  const WalkReplay& r = report.replay;
  return fmt::format(
      "{} along {}, {} x {} pixels, by {} on {}. {} a method, the order of methods rotated; one more replay, "
      "the "
      "first, is dropped.{}",
      counted(report.frames.cameras.size(), "frame"), report.path, report.width, report.height,
      counted(r.methods.size(), "culling method"), report.device.name,
      counted(report.options.repeats, "whole replay"),
      r.complete          ? ""
      : r.problem.empty() ? " Stopped before the end: what follows is of the frames that were drawn."
                          : " Ended early: " + r.problem + ".");
}

}  // namespace

HtmlReport walkPage(const WalkReport& report, const WalkPictures& pictures, const std::string& command) {
  HtmlReport page("A walk through " + report.scene.name);
  page.text(introText(report));
  page.section("Methods");
  page.table(methodsTable(report));
  page.text(
      "1 % low: frames a second of the slowest hundredth of frames, on average. GPU ms: from a frame's first "
      "command to "
      "its last.");
  for (const std::string& line : leftOutLines(report)) page.text(line + ".");
  for (const std::string& line : walkNotes(report)) page.text("Note: " + line + ".");
  const std::vector<WalkStretch> stretches = stretchesOf(report.frames);
  if (stretches.size() > 1 && stretches.size() <= 8) page.table(stretchTable(report, stretches));
  addTimes(page, report);
  addParts(page, report);
  addQueries(page, report);
  addDrawn(page, report);
  if (!pictures.drawn.empty()) {
    page.text(
        "From above: what the frame drew green, the rest of the scene grey, the camera's view between orange "
        "lines.");
    page.pictures(pictures.drawn);
  }
  addSetTable(page, report);
  addCellTable(page, report);
  addWrong(page, report, pictures);
  page.section("Scene and walk");
  const ChcOptions& chc = report.options.method.chc;
  page.facts({{"triangles", std::to_string(report.scene.triangles)},
              {"objects, large ones cut", std::to_string(report.drawables)},
              {"triangles of one, at most", report.split == 0 ? "any" : std::to_string(report.split)},
              {"field of view", fmt::format("{:g} degrees", report.fov)},
              {"frames in flight", std::to_string(report.options.in_flight)},
              {"schedule", report.options.method.schedule.fixed ? "fixed" : "live"},
              {"submits wait by", report.chain.empty() ? "-" : report.chain},
              {"batch size", std::to_string(chc.batch_size)},
              {"assumed visible", counted(chc.assumed_frames, "frame")},
              {"set", report.pvs.empty() ? "none" : report.pvs},
              {"seconds", fmt::format("{:.1f}", report.replay.seconds)}});
  page.repeat({.command = command,
               .seed = std::to_string(report.options.method.schedule.seed),
               .device = report.device.id + ", " + report.device.name,
               .driver = report.device.driver,
               .version = report.version});
  return page;
}

}  // namespace sightline

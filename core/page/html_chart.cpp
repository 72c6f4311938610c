#include "core/page/html_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/page/html_text.h"

namespace sightline {
namespace {

std::string seriesHtml(const ChartSeries& series, const std::vector<ChartPoint>& points, uint32_t color) {
  std::string html = fmt::format(
      "<tbody data-color=\"{}\"{}{}{}{}{}>\n<tr><th colspan=\"2\" scope=\"rowgroup\">{}</th></tr>\n", color,
      series.dots ? " data-dots" : "", series.dashed ? " data-dashed" : "", series.fills ? " data-fills" : "",
      series.in_legend ? "" : " data-unlisted", series.on_demand ? " data-on-demand" : "",
      escapeHtml(series.name));
  for (const ChartPoint& point : points)
    html += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", point.x, point.y);
  return html + "</tbody>\n";
}

/// Those that are finite.
std::vector<ChartPoint> drawable(const std::vector<ChartPoint>& points) {
  std::vector<ChartPoint> finite;
  std::copy_if(points.begin(), points.end(), std::back_inserter(finite),
               [](const ChartPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y); });
  return finite;
}

std::string headHtml(const ReportChart& chart, const char* kind) {
  std::string html = fmt::format("<figure class=\"{}\"{}{}{}", kind, chart.log_x ? " data-log-x" : "",
                                 chart.log_y ? " data-log-y" : "", chart.stacked ? " data-stacked" : "");
  if (!chart.pick.empty()) html += fmt::format(" data-pick=\"{}\"", escapeHtml(chart.pick));
  html += fmt::format(">\n<figcaption><b>{}</b>", escapeHtml(chart.title));
  if (!chart.note.empty()) html += fmt::format("<span class=\"note\">{}</span>", escapeHtml(chart.note));
  return html + "</figcaption>\n";
}

std::string summaryLine(size_t shown, size_t all) {
  if (shown == all) return fmt::format("Data: {} points", all);
  return fmt::format("Data: {} of {} points", shown, all);
}

}  // namespace

std::vector<ChartPoint> thinned(std::span<const ChartPoint> points, bool log_x, size_t most) {
  if (points.size() <= most) return {points.begin(), points.end()};
  const auto place = [&](double x) { return log_x ? std::log(std::max(x, 1e-300)) : x; };
  // A logarithmic axis begins at its first positive x.
  const auto first =
      std::find_if(points.begin(), points.end(), [&](ChartPoint p) { return !log_x || p.x > 0; });
  const double low = place(first == points.end() ? 1 : first->x);
  const double width = place(points.back().x) - low;
  const size_t parts = most - 1;
  const auto part = [&](double x) {
    const double share = width > 0 ? (place(x) - low) / width : 1;
    return size_t(std::clamp(std::ceil(share * double(parts)), 1.0, double(parts)));
  };
  std::vector<ChartPoint> kept = {points.front()};
  for (size_t i = 1; i < points.size(); ++i) {
    const bool last_of_its_part = i + 1 == points.size() || part(points[i].x) != part(points[i + 1].x);
    if (last_of_its_part && kept.size() < most) kept.push_back(points[i]);
  }
  return kept;
}

std::string chartHtml(const ReportChart& chart) {
  std::string bodies, names;
  size_t shown = 0, all = 0;
  for (size_t i = 0; i < chart.series.size(); ++i) {
    const ChartSeries& series = chart.series[i];
    const std::vector<ChartPoint> points = drawable(series.points);
    const size_t most = series.on_demand ? kMaxOnDemandPoints : kMaxChartPoints;
    const std::vector<ChartPoint> kept = thinned(points, chart.log_x, most);
    bodies += seriesHtml(series, kept, series.color.value_or(uint32_t(i)));
    if (series.in_legend && !series.on_demand) names += (names.empty() ? "" : ", ") + series.name;
    shown += kept.size();
    all += points.size();
  }
  if (all == 0)
    return headHtml(chart, "no-chart") + "<p class=\"note\">There is nothing to draw.</p>\n</figure>\n";
  return headHtml(chart, "chart") +
         fmt::format("<div class=\"plot\"><canvas role=\"img\" aria-label=\"{}\"></canvas></div>\n",
                     escapeHtml(fmt::format("{}: {} over {}; {}. The data follows as a table.", chart.title,
                                            chart.y, chart.x, names))) +
         fmt::format(
             "<div class=\"legend\"></div>\n<details><summary>{}</summary>"
             "<div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr><th>{}</th><th>{}</th></tr></thead>\n"
             "{}</table></div></details>\n</figure>\n",
             summaryLine(shown, all), escapeHtml(chart.x), escapeHtml(chart.y), bodies);
}

std::string spansHtml(const ReportSpans& chart) {
  std::vector<std::string> names;  // by colour
  double end = 0;
  for (const auto& [row, spans] : chart.rows) {
    for (const ReportSpan& span : spans) {
      end = std::max(end, span.end);
      if (std::find(names.begin(), names.end(), span.name) == names.end()) names.push_back(span.name);
    }
  }
  if (!(end > 0)) end = 1;
  const auto colorOf = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) - names.begin();
  };
  std::string html = fmt::format("<figure class=\"spans\">\n<figcaption><b>{}</b>", escapeHtml(chart.title));
  if (!chart.note.empty()) html += fmt::format("<span class=\"note\">{}</span>", escapeHtml(chart.note));
  html += "</figcaption>\n<div class=\"rows\">\n";
  for (const auto& [row, spans] : chart.rows) {
    html += fmt::format("<div class=\"row\"><span>{}</span><div class=\"bar\">", escapeHtml(row));
    for (const ReportSpan& span : spans) {
      html += fmt::format(
          "<i class=\"s{}\" style=\"left:{:.4f}%;width:{:.4f}%\" title=\"{}: {:.4g} {}, from {:.4g}\"></i>",
          colorOf(span.name) % 10, 100 * span.begin / end, 100 * (span.end - span.begin) / end,
          escapeHtml(span.name), span.end - span.begin, escapeHtml(chart.unit), span.begin);
    }
    html += "</div></div>\n";
  }
  html += "<div class=\"row axis\"><span></span><div class=\"ticks\">";
  for (int tick = 0; tick <= 4; ++tick) {
    html +=
        fmt::format("<span>{:.3g}{}</span>", end * tick / 4, tick == 4 ? " " + escapeHtml(chart.unit) : "");
  }
  html += "</div></div>\n</div>\n<div class=\"names\">";
  for (size_t i = 0; i < names.size(); ++i) {
    html += fmt::format("<span><i class=\"s{}\"></i>{}</span>", i % 10, escapeHtml(names[i]));
  }
  return html + "</div>\n</figure>\n";
}

}  // namespace sightline

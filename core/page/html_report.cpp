#include "core/page/html_report.h"

#include <fmt/format.h>

#include <stdexcept>

#include "core/io/base64.h"
#include "core/io/file_io.h"
#include "core/page/html_chart.h"
#include "core/page/html_text.h"
#include "core/page/parts/parts.h"

namespace sightline {
namespace {

/// Nothing may be fetched, not even by a mistake of ours: the browser itself refuses.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; base-uri "
    "'none'; "
    "form-action 'none'";

std::string rowHtml(const ReportTable& table, const std::vector<std::string>& cells, bool head) {
  std::string html = "<tr>";
  for (size_t i = 0; i < cells.size(); ++i) {
    const bool text = i < table.text_columns;
    const char* tag = head || (text && i == 0) ? "th" : "td";
    const char* scope = head ? " scope=\"col\"" : text && i == 0 ? " scope=\"row\"" : "";
    const char* look = !text                                  ? ""
                       : !head && i == 0 && table.short_names ? " class=\"left word\""
                                                              : " class=\"left\"";
    html += fmt::format("<{}{}{}>{}</{}>", tag, scope, look, escapeHtml(cells[i]), tag);
  }
  return html + "</tr>\n";
}

std::string navigation(const std::vector<std::string>& sections) {
  if (sections.size() < 2) return "";
  std::string html = "<nav aria-label=\"Sections\">\n";
  for (size_t i = 0; i < sections.size(); ++i) {
    html += fmt::format("<a href=\"#section-{}\">{}</a>\n", i + 1, escapeHtml(sections[i]));
  }
  return html + "</nav>\n";
}

}  // namespace

HtmlReport::HtmlReport(std::string title) : title_(std::move(title)) {}

void HtmlReport::section(std::string_view title) {
  sections_.emplace_back(title);
  body_ += fmt::format("<h2 id=\"section-{}\">{}</h2>\n", sections_.size(), escapeHtml(title));
}

void HtmlReport::text(std::string_view paragraph) {
  body_ += fmt::format("<p>{}</p>\n", escapeHtml(paragraph));
}

void HtmlReport::facts(std::span<const ReportFact> facts) {
  body_ += "<dl>\n";
  for (const auto& [name, value] : facts) {
    body_ += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", escapeHtml(name), escapeHtml(value));
  }
  body_ += "</dl>\n";
}

void HtmlReport::table(const ReportTable& table) {
  body_ += "<figure class=\"scroll\" tabindex=\"0\"><table>\n";
  if (!table.caption.empty()) body_ += fmt::format("<caption>{}</caption>\n", escapeHtml(table.caption));
  body_ += "<thead>" + rowHtml(table, table.columns, true) + "</thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) {
    if (row.size() != table.columns.size())
      throw std::invalid_argument("a row of another length than the columns");
    body_ += rowHtml(table, row, false);
  }
  body_ += "</tbody>\n</table></figure>\n";
}

void HtmlReport::charts(std::span<const ReportChart> charts) {
  body_ += "<div class=\"charts\">\n";
  for (const ReportChart& chart : charts) body_ += chartHtml(chart);
  body_ += "</div>\n";
}

void HtmlReport::spans(const ReportSpans& chart) {
  body_ += spansHtml(chart);
}

void HtmlReport::pictures(std::span<const ReportPicture> pictures) {
  body_ += fmt::format("<div class=\"pictures{}\">\n", pictures.size() > kLargePictures ? " many" : "");
  for (const ReportPicture& picture : pictures) {
    body_ += fmt::format(
        "<figure class=\"picture\"><img alt=\"{}\" "
        "src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
        escapeHtml(picture.alt.empty() ? picture.caption : picture.alt), encodeBase64(picture.png),
        escapeHtml(picture.caption));
  }
  body_ += "</div>\n";
}

void HtmlReport::repeat(const ReportRepeat& repeat) {
  section("How to repeat it");
  body_ += fmt::format("<pre>{}</pre>\n", escapeHtml(repeat.command));
  std::vector<ReportFact> known;
  for (const ReportFact& fact :
       {ReportFact{"seed", repeat.seed}, ReportFact{"device", repeat.device},
        ReportFact{"driver", repeat.driver}, ReportFact{"sightline", repeat.version}}) {
    if (!fact.second.empty()) known.push_back(fact);
  }
  facts(known);
}

std::string HtmlReport::html() const {
  const std::string title = escapeHtml(title_);
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"generator\" content=\"Sightline\">\n<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{}</title>\n<style>\n",
      kPolicy, title);
  page += kPageStyle;
  page += fmt::format("</style>\n</head>\n<body>\n<header>\n<h1>{}</h1>\n{}</header>\n<main>\n", title,
                      navigation(sections_));
  page += body_;
  page += fmt::format(
      "</main>\n<footer>\n<p>Written by Sightline. Charts by Chart.js, MIT licence.</p>\n"
      "<details><summary>Licence of Chart.js</summary><pre>{}</pre></details>\n</footer>\n",
      escapeHtml(kPageLicences));
  page += "<script>\n";
  page += kChartScript;
  page += "\n</script>\n<script>\n";
  page += kPageScript;
  page += kReadingScript;
  page += "</script>\n</body>\n</html>\n";
  return page;
}

void HtmlReport::save(const std::filesystem::path& file) const {
  saveText(html(), file);
}

}  // namespace sightline

#include "core/page/html_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <stdexcept>

#include "core/io/base64.h"
#include "core/io/csv.h"
#include "core/page/html_text.h"
#include "core/page/parts/parts.h"
#include "tests/support/count_of.h"
#include "tests/support/example_page.h"

namespace sightline {
namespace {

using testing_support::countOf;
using testing_support::examplePage;
using testing_support::kHostileName;

/// The page without the parts that are the same in all: what is made of data.
std::string variablePart(const std::string& html) {
  const size_t begin = html.find("<main>"), end = html.find("</main>");
  return html.substr(begin, end - begin);
}

TEST(HtmlReport, EscapesText) {
  EXPECT_EQ(escapeHtml("a<b>&\"'"), "a&lt;b&gt;&amp;&quot;&#39;");
  EXPECT_EQ(escapeHtml("caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x8f\x99 \t\n"),
            "caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x8f\x99 \t\n");
  const std::string bad = "\xef\xbf\xbd";
  EXPECT_EQ(escapeHtml("caf\xe9"), "caf" + bad);
  EXPECT_EQ(escapeHtml("\xe2\x82"), bad + bad);
  EXPECT_EQ(escapeHtml("\xc0\xbc"), bad + bad) << "an overlong <";
  EXPECT_EQ(escapeHtml("\xed\xa0\x80"), bad + bad + bad) << "half a surrogate pair";
  EXPECT_EQ(escapeHtml("\xf4\x90\x80\x80"), bad + bad + bad + bad) << "above U+10FFFF";
  EXPECT_EQ(escapeHtml(std::string("a\0b\x1b\x7f\xc2\x85", 7)), "a" + bad + "b" + bad + bad + bad);
}

TEST(HtmlReport, EveryShortByteStringStaysUtf8AndKeepsItsPlace) {
  // All pairs of bytes: no bare < or quote comes out, and plain characters stay.
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const std::string text = {char(first), char(second), 'x'};
      const std::string html = escapeHtml(text);
      ASSERT_EQ(html.find_first_of("<>\"'"), std::string::npos) << first << " " << second;
      ASSERT_EQ(html.back(), 'x') << first << " " << second;
    }
  }
}

TEST(HtmlReport, NoNameBreaksThePage) {
  const std::string html = examplePage().html();
  EXPECT_EQ(html.find(kHostileName), std::string::npos);
  EXPECT_GE(countOf(html, escapeHtml(kHostileName)), 10u);
  EXPECT_EQ(countOf(html, "<script"), countOf(html, "</script"));
  EXPECT_EQ(countOf(html, "</script"), 2u) << "Chart.js and the page's script";
  EXPECT_EQ(countOf(html, "</style"), 1u);
  EXPECT_EQ(countOf(variablePart(html), "<img "), 2u);
  EXPECT_EQ(countOf(html, "<!--"), 0u);
}

TEST(HtmlReport, IsOneFileThatFetchesNothing) {
  const std::string html = examplePage().html();
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  const std::regex reference("(src|href)=\"([^\"]*)\"");
  size_t references = 0;
  for (std::sregex_iterator i(html.begin(), html.begin() + std::ptrdiff_t(html.find("<footer>")), reference),
       end;
       i != end; ++i) {
    const std::string target = (*i)[2];
    ++references;
    EXPECT_TRUE(target.starts_with("data:") || target.starts_with("#section-")) << target;
  }
  EXPECT_EQ(references, 1u + 5u + 2u) << "icon, sections, pictures";
  for (const std::string_view part : {kPageStyle, kPageScript}) {
    EXPECT_EQ(part.find("url("), std::string::npos);
    EXPECT_EQ(part.find("://"), std::string::npos);
  }
}

TEST(HtmlReport, CarriesTheLicenceOfChartJs) {
  const std::string html = examplePage().html();
  EXPECT_NE(html.find("Chart.js v3"), std::string::npos);
  EXPECT_NE(html.find("Released under the MIT License"), std::string::npos);
  EXPECT_NE(html.find("Chart.js Contributors"), std::string::npos);
  EXPECT_NE(html.find("Permission is hereby granted"), std::string::npos);
}

TEST(HtmlReport, SameDataGiveTheSameBytes) {
  EXPECT_EQ(examplePage().html(), examplePage().html());
}

TEST(HtmlReport, RefusesRowsOfAnotherLength) {
  HtmlReport page("x");
  EXPECT_THROW(page.table({.columns = {"a", "b"}, .rows = {{"1"}}}), std::invalid_argument);
  EXPECT_THROW(Csv({"a"}).row({"1", "2"}), std::invalid_argument);
}

TEST(HtmlReport, ChartDataStandsInATableWithAllDigits) {
  HtmlReport page("x");
  page.charts(
      {{.title = "t",
        .x = "seconds",
        .y = "share",
        .series = {{.name = "a", .points = {{0.1, 1e-7}, {3, std::nan("")}, {1.0 / 3, 123456789012.0}}}}}});
  const std::string html = page.html();
  EXPECT_NE(
      html.find("<tr><td>0.1</td><td>1e-07</td></tr>\n<tr><td>0.3333333333333333</td><td>123456789012</td>"),
      std::string::npos)
      << variablePart(html);
  EXPECT_NE(html.find("Data: 2 points"), std::string::npos);
  EXPECT_NE(html.find("<thead><tr><th>seconds</th><th>share</th></tr></thead>"), std::string::npos);
}

TEST(HtmlReport, ThinsLongLinesEvenlyAlongTheAxis) {
  std::vector<ChartPoint> points;
  for (int i = 0; i < 10'000; ++i) points.push_back({double(i), double(i * i)});
  for (const bool log_x : {false, true}) {
    const std::vector<ChartPoint> kept = thinned(points, log_x, 100);
    ASSERT_LE(kept.size(), 100u);
    ASSERT_GE(kept.size(), 60u);
    EXPECT_EQ(kept.front().x, 0);
    EXPECT_EQ(kept.back().x, 9999);
    for (size_t i = 1; i < kept.size(); ++i) ASSERT_GT(kept[i].x, kept[i - 1].x);
    // Half of the axis has half of the points.
    const double middle = log_x ? 100 : 5000;
    const auto below = std::count_if(kept.begin(), kept.end(), [&](ChartPoint p) { return p.x <= middle; });
    EXPECT_NEAR(double(below), double(kept.size()) / 2, double(kept.size()) / 8) << log_x;
  }
  EXPECT_EQ(thinned(std::vector<ChartPoint>(5, {1, 1}), true, 100).size(), 5u);
  EXPECT_LE(thinned(std::vector<ChartPoint>(500, {1, 1}), true, 100).size(), 100u);
  EXPECT_LE(thinned(std::vector<ChartPoint>(500, {0, 1}), true, 100).size(), 100u);
}

TEST(HtmlReport, SavesUnderItsNameOnlyWhenComplete) {
  HtmlReport page("x");
  EXPECT_THROW(page.save("/no/such/folder/x.html"), std::exception);
}

TEST(Csv, QuotesWhatMustBe) {
  Csv csv({"cell", "x"});
  csv.row({"a,b", "1"});
  csv.row({"say \"hi\"", "2"});
  csv.row({"two\nlines", ""});
  EXPECT_EQ(csv.text(), "cell,x\n\"a,b\",1\n\"say \"\"hi\"\"\",2\n\"two\nlines\",\n");
}

TEST(Base64, EncodesAndDecodesEveryLength) {
  const auto encode = [](std::string_view text) {
    return encodeBase64({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  };
  // RFC 4648, section 10.
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foob"), "Zm9vYg==");
  EXPECT_EQ(encode("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
  std::vector<uint8_t> bytes;
  for (int i = 0; i < 600; ++i) {
    EXPECT_EQ(decodeBase64(encodeBase64(bytes)), bytes) << i;
    bytes.push_back(uint8_t(i * 37 + i / 256));
  }
}

}  // namespace
}  // namespace sightline

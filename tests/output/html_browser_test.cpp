// HTML reports in a real browser: what a reader of a phone, a desktop and paper gets.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/bake/bake_page.h"
#include "core/walk/walk_page.h"
#include "tests/output/example_pvs.h"
#include "tests/support/chromium.h"
#include "tests/support/example_page.h"

namespace sightline {
namespace {

using nlohmann::json;
using testing_support::examplePage;
using testing_support::kHostileName;
using testing_support::runChromium;

/// Goes before everything else in the page: keeps what goes wrong.
constexpr const char* kWatch = R"(<script>
window.wrong = [];
addEventListener('error', (e) => wrong.push('error: ' + (e.message || e.target.tagName)), true);
addEventListener('unhandledrejection', (e) => wrong.push('rejection: ' + e.reason));
addEventListener('securitypolicyviolation', (e) => wrong.push('fetches ' + e.blockedURI));
for (const kind of ['error', 'warn']) console[kind] = (...words) => wrong.push(kind + ': ' + words.join(' '));
</script>)";

/// Goes to the end: measures, and leaves the answer in the document.
constexpr const char* kMeasure = R"(<script>
addEventListener('load', () => setTimeout(() => {
  const colors = (canvas) => {
    const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data, seen = new Set();
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] > 200) seen.add(pixels[i] << 16 | pixels[i + 1] << 8 | pixels[i + 2]);
    }
    return seen.size;
  };
  const root = document.scrollingElement;
  const answer = {
    wrong, broken: window.broken || 0, width: innerWidth, scroll_width: root.scrollWidth,
    title: document.title,
    colors: Array.from(document.querySelectorAll('.plot canvas'), colors),
    legends: Array.from(document.querySelectorAll('.legend'), (box) => box.children.length),
    plot_widths: Array.from(document.querySelectorAll('.plot canvas'), (c) => c.getBoundingClientRect().width),
    pictures: Array.from(document.querySelectorAll('.pictures img'), (i) => i.naturalWidth),
    fetched: performance.getEntriesByType('resource').map((e) => e.name).filter((n) => !n.startsWith('data:')),
    hostile: document.querySelector('tbody tr:last-child th').textContent,
    legend_heights: Array.from(document.querySelectorAll('.legend'), (box) => box.getBoundingClientRect().height),
    plot_heights: Array.from(document.querySelectorAll('.plot'), (box) => box.getBoundingClientRect().height),
    hints: Array.from(document.querySelectorAll('main > .hint'), (hint) => hint.getBoundingClientRect().height > 0),
    faded: Array.from(document.querySelectorAll('main > .scroll'), (box) => getComputedStyle(box).maskImage !== 'none' ||
                                                                 getComputedStyle(box).webkitMaskImage !== 'none'),
    tables: Array.from(document.querySelectorAll('main > .scroll'), (box) => box.scrollWidth > box.clientWidth),
    said: window.said || null,
    unlabelled: Array.from(document.querySelectorAll('img:not([alt]), canvas:not([aria-label]):not([aria-hidden])'))
        .length,
  };
  const pre = document.createElement('pre');
  pre.id = 'answer';
  pre.textContent = JSON.stringify(answer);
  parent === window ? document.body.append(pre) : parent.document.body.append(pre);
}, 100));
</script>)";

class HtmlInBrowser : public ::testing::Test {
 protected:
  void SetUp() override { SL_SKIP_WITHOUT_CHROMIUM(); }

  std::string write(const std::string& name, const std::string& html) {
    std::ofstream(folder_ / name) << html;
    return "'file://" + (folder_ / name).string() + "'";
  }

  /// The page with the two scripts.
  static std::string watched(std::string html) {
    html.insert(html.find("<title>"), kWatch);
    html.insert(html.rfind("</body>"), kMeasure);
    return html;
  }

  /// Opens the page in a window as wide, and returns what kMeasure found.
  json measure(const std::string& html, int width) {
    // A frame is as narrow as one likes; a window is not.
    write("page.html", watched(html));
    const std::string frame = write(
        "frame.html", "<!DOCTYPE html><body style='margin:0'><iframe src='page.html' style='border:0;width:" +
                          std::to_string(width) + "px;height:900px'></iframe></body>");
    const auto run =
        runChromium(folder_ / "profile",
                    "--allow-file-access-from-files --window-size=1600,1000 --virtual-time-budget=5000 "
                    "--dump-dom " +
                        frame);
    EXPECT_EQ(run.exit_code, 0) << run.output;
    const std::string begin = "<pre id=\"answer\">";
    const size_t at = run.output.find(begin);
    if (at == std::string::npos) {
      ADD_FAILURE() << "no answer in " << run.output.substr(0, 2000);
      return {};
    }
    std::string text =
        run.output.substr(at + begin.size(), run.output.find("</pre>", at) - at - begin.size());
    for (const auto& [entity, character] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}}) {
      for (size_t i = 0; (i = text.find(entity, i)) != std::string::npos; ++i) {
        text.replace(i, std::string(entity).size(), character);
      }
    }
    return json::parse(text);
  }

  TemporaryFolder folder_;
};

TEST_F(HtmlInBrowser, DrawsItsChartsAndFetchesNothing) {
  const json page = measure(examplePage().html(), 1280);
  EXPECT_EQ(page["wrong"], json::array());
  EXPECT_EQ(page["fetched"], json::array());
  EXPECT_EQ(page["broken"], 0);
  EXPECT_EQ(page["title"], "Bake of " + kHostileName);
  EXPECT_EQ(page["hostile"], kHostileName);
  EXPECT_EQ(page["unlabelled"], 0);
  EXPECT_EQ(page["pictures"], (json{320, 320}));
  EXPECT_EQ(page["legends"], (json{5, 10}));
  ASSERT_EQ(page["colors"].size(), 2u);
  EXPECT_GE(page["colors"][0], 6) << "ink, lines of five colours";
  EXPECT_GE(page["colors"][1], 11);
  EXPECT_LE(page["scroll_width"], page["width"]);
}

TEST_F(HtmlInBrowser, FitsAPhone) {
  const json page = measure(examplePage().html(), 390);
  EXPECT_EQ(page["width"], 390);
  EXPECT_EQ(page["scroll_width"], 390);
  for (const json& width : page["plot_widths"]) EXPECT_TRUE(width > 300 && width < 390) << width;
  EXPECT_EQ(page["wrong"], json::array());
}

/// The page of a bake, as a reader gets it.
TEST_F(HtmlInBrowser, ShowsABake) {
  BakeReport report;
  report.scene.name = "city.glb";
  report.scene.triangles = 1000;
  report.cells = summarize(examplePvs());
  report.planned_cells = 3;
  BakePage bake;
  bake.curves.resize(2);
  for (uint32_t i = 1; i < 2000; ++i) {
    bake.curves[0].push_back({0.01 * i, {1000 * i, 500 * i, 0}, {10 + i, i / 2, 0}, 10 + i + i / 2, i / 10});
  }
  bake.curves[1] = bake.curves[0];
  for (const int width : {390, 1280}) {
    const json page = measure(bakePage(report, bake).html(), width);
    EXPECT_EQ(page["wrong"], json::array());
    EXPECT_EQ(page["scroll_width"], width);
    EXPECT_EQ(page["legends"], (json{2, 2, 2, 2, 2, 2})) << "random and border: reverse found nothing";
    for (const json& colors : page["colors"]) EXPECT_GE(colors, 3);
  }
}

/// The page of a walk: stacked areas keep their sum, bars stay in their row.
TEST_F(HtmlInBrowser, ShowsAWalk) {
  WalkReport report;
  report.scene.name = "city.glb";
  report.width = report.height = 100;
  report.gpu_times = true;
  report.frames.cameras.resize(500);
  report.frames.cuts = {250};
  for (const char* name :
       {"none", "vfc", "stop-and-wait", "chc", "chc++", "opti-chc++", "late", "hiz", "pvs"}) {
    MethodReplay m;
    m.name = name;
    for (uint32_t i = 0; i < 500; ++i) {
      m.times.push_back({.frame = 1 + i % 7 * 0.5,
                         .cpu = {0.1, 0.2, 0.3, 0.4, 0.5},
                         .gpu = {1, 2, 0, 0, 0.25},
                         .gpu_frame = 3.25});
      m.counts.push_back({.submits = 3, .objects = 10 + i, .triangles = 1000 + i, .queries = i % 5});
      m.checks.push_back({i % 50 == 0 ? 3u : 0u, 0, 3, 1, 8, 800});
    }
    report.replay.methods.push_back(m);
  }
  report.replay.traced = {{.frame = 0, .milliseconds = 1, .drawables = 8, .triangles = 90}};
  for (const int width : {390, 1280}) {
    std::string html = walkPage(report, {}, "sightline walk").html();
    html.insert(html.rfind("</body>"), R"(<script>
      const stacked = document.querySelector('figure[data-stacked]');
      const chart = Chart.getChart(stacked.querySelector('canvas'));
      const bars = Array.from(document.querySelectorAll('.spans .bar'), (bar) => Array.from(bar.children, (i) => {
        const box = i.getBoundingClientRect(), row = bar.getBoundingClientRect();
        return [(box.left - row.left) / row.width, (box.right - row.left) / row.width];
      }));
      window.said = {top: chart.scales.y.max, parts: chart.data.datasets.map((set) => set.label), bars};
    </script>)");
    const json page = measure(html, width);
    EXPECT_EQ(page["wrong"], json::array());
    EXPECT_EQ(page["scroll_width"], width);
    for (const json& colors : page["colors"]) EXPECT_GE(colors, 3);
    const json& said = page["said"];
    EXPECT_GE(said["top"], 3.25) << "the parts' sum";
    EXPECT_LE(said["top"], 4);
    EXPECT_EQ(said["parts"], (json{"draw", "query", "rest"}));
    ASSERT_EQ(said["bars"].size(), 2u);
    EXPECT_NEAR(said["bars"][1][1][0].get<double>(), 1 / 3.25, 0.01) << "query begins where draw ends";
    EXPECT_NEAR(said["bars"][1][2][1].get<double>(), 1, 0.01);
    EXPECT_NEAR(said["bars"][0][4][1].get<double>(), 1.5 / 3.25, 0.01);
  }
}

/// The page of so many cells, with curves.
std::string pageOfCurves(size_t cells) {
  BakeReport report;
  report.scene.name = "city.glb";
  report.scene.triangles = 100'000;
  report.cells.resize(cells, summarize(examplePvs())[0]);
  report.planned_cells = cells;
  BakePage bake;
  for (size_t i = 0; i < cells; ++i) {
    report.cells[i].cell.name = "street-" + std::to_string(i + 1);
    bake.curves.emplace_back();
    for (uint32_t k = 1; k < 40; ++k) {
      bake.curves.back().push_back(
          {0.1 * k, {uint64_t(1000) * k, 0, 0}, {k, 0, 0}, uint32_t(100 * (i + 1)) + 5 * k, k});
    }
  }
  return bakePage(report, bake).html();
}

/// A legend of fifty names would be larger than its chart.
TEST_F(HtmlInBrowser, ALegendStaysSmallerThanItsChart) {
  HtmlReport many("many");
  many.table({.columns = {"a"}, .rows = {{"b"}}});
  many.charts({testing_support::exampleChart("Fifty lines", true, 50, 30)});
  for (const int width : {390, 1280}) {
    for (const std::string& html : {pageOfCurves(50), many.html()}) {
      const json page = measure(html, width);
      EXPECT_EQ(page["wrong"], json::array());
      EXPECT_EQ(page["scroll_width"], width);
      ASSERT_GT(page["legend_heights"].size(), 0u);
      for (size_t i = 0; i < page["legend_heights"].size(); ++i) {
        EXPECT_LT(page["legend_heights"][i].get<double>(), 0.6 * page["plot_heights"][i].get<double>());
      }
    }
  }
}

/// Picks two of fifty cells, by keys and by a click, then takes one back.
TEST_F(HtmlInBrowser, ShowsSingleCellsOnDemand) {
  std::string html = pageOfCurves(50);
  html.insert(html.rfind("</body>"), R"(<script>
    const shown = () => Array.from(document.querySelectorAll('.charts')[0].querySelectorAll('figure'), (figure) => {
      const chart = Chart.getChart(figure.querySelector('canvas'));
      return {sets: chart.data.datasets.filter((set, i) => chart.isDatasetVisible(i)).map((set) => set.label),
              legend: Array.from(figure.querySelectorAll('.legend button'), (button) => button.textContent),
              x: [chart.scales.x.min, chart.scales.x.max]};
    });
    const boxes = document.querySelectorAll('.pick input[type=checkbox]');
    window.said = {boxes: boxes.length, before: shown(), lists: document.querySelectorAll('.pick').length};
    document.querySelector('.pick').open = true;
    boxes[6].focus();
    said.focused = document.activeElement === boxes[6];
    boxes[6].click();
    boxes[41].click();
    said.two = shown();
    boxes[6].click();
    said.one = shown();
    const find = document.querySelector('.pick input[type=search]');
    find.value = 'STREET-4';
    find.dispatchEvent(new Event('input'));
    said.found = Array.from(boxes).filter((box) => box.getBoundingClientRect().height > 0).length;
    document.querySelector('.pick button').click();
    said.none = shown();
  </script>)");
  const json page = measure(html, 1280);
  EXPECT_EQ(page["wrong"], json::array());
  const json& said = page["said"];
  EXPECT_EQ(said["lists"], 1) << "one for both charts";
  EXPECT_EQ(said["boxes"], 50);
  EXPECT_EQ(said["focused"], true);
  EXPECT_EQ(said["found"], 11) << "street-4 and street-40 to street-49";
  const json all = {"median", "lowest", "highest"}, legend = {"median", "lowest to highest"};
  for (size_t chart = 0; chart < 2; ++chart) {
    EXPECT_EQ(said["before"][chart]["sets"], all);
    EXPECT_EQ(said["before"][chart]["legend"], legend);
    EXPECT_EQ(said["two"][chart]["legend"], (json{"median", "lowest to highest", "street-7", "street-42"}));
    EXPECT_EQ(said["two"][chart]["sets"], (json{"median", "lowest", "highest", "street-7", "street-7, T = 10",
                                                "street-42", "street-42, T = 10"}));
    EXPECT_EQ(said["one"][chart]["legend"], (json{"median", "lowest to highest", "street-42"}));
    EXPECT_EQ(said["none"][chart]["sets"], all);
    EXPECT_EQ(said["two"][chart]["x"], said["before"][chart]["x"]) << "the axis stays";
  }
}

/// Of many cells the pictures are small, and each can be enlarged.
TEST_F(HtmlInBrowser, EnlargesSmallPictures) {
  HtmlReport report("many pictures");
  report.table({.columns = {"a"}, .rows = {{"b"}}});
  const std::vector<uint8_t> png = encodePng(Image(320, 240, {40, 160, 60}));
  report.pictures(std::vector<ReportPicture>(kLargePictures + 1, {.png = png, .caption = "a cell"}));
  std::string html = report.html();
  html.insert(html.rfind("</body>"), R"(<script>
    const image = document.querySelectorAll('.pictures img')[2], button = image.closest('button');
    const width = () => Math.round(image.getBoundingClientRect().width);
    window.said = {widths: [width()], expanded: [button.getAttribute('aria-expanded')]};
    for (let i = 0; i < 2; ++i) {
      button.click();
      said.widths.push(width());
      said.expanded.push(button.getAttribute('aria-expanded'));
    }
  </script>)");
  for (const int width : {400, 1280}) {
    const json page = measure(html, width);
    EXPECT_EQ(page["wrong"], json::array());
    EXPECT_EQ(page["scroll_width"], width);
    const json& widths = page["said"]["widths"];
    EXPECT_LT(widths[0], width / 2);
    EXPECT_GT(widths[1], 0.85 * width);
    EXPECT_EQ(widths[2], widths[0]);
    EXPECT_EQ(page["said"]["expanded"], (json{"false", "true", "false"}));
  }
}

/// Where a table is wider than the page, its edge fades and a line says so.
TEST_F(HtmlInBrowser, SaysThatATableScrolls) {
  const json phone = measure(pageOfCurves(2), 400);
  EXPECT_EQ(phone["tables"], json::array({true}));
  EXPECT_EQ(phone["hints"], json::array({true}));
  EXPECT_EQ(phone["faded"], json::array({true}));
  const json desktop = measure(pageOfCurves(2), 1500);
  EXPECT_EQ(desktop["tables"], json::array({false}));
  EXPECT_EQ(desktop["hints"], json::array({false}));
  EXPECT_EQ(desktop["faded"], json::array({false}));
}

TEST_F(HtmlInBrowser, TheWatchWorks) {
  HtmlReport page("x");
  page.table({.columns = {"a"}, .rows = {{"b"}}});
  std::string html = page.html();
  html.insert(html.find("<h1>"),
              "<img alt='' src='http://example.invalid/x.png'><script>undefinedName()</script>"
              "<div style='width:2000px'>wide</div>");
  const json answer = measure(html, 390);
  EXPECT_GT(answer["scroll_width"], 390);
  EXPECT_NE(answer["wrong"].dump().find("undefinedName"), std::string::npos) << answer["wrong"];
  EXPECT_NE(answer["wrong"].dump().find("fetches http"), std::string::npos) << answer["wrong"];
}

TEST_F(HtmlInBrowser, Prints) {
  const std::string page = write("page.html", examplePage().html());
  const auto pdf = folder_ / "page.pdf";
  const auto run =
      runChromium(folder_ / "profile", "--virtual-time-budget=5000 --no-pdf-header-footer --print-to-pdf='" +
                                           pdf.string() + "' " + page);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  const std::vector<uint8_t> bytes = readBytes(pdf);
  ASSERT_GT(bytes.size(), 20'000u);
  EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 5), "%PDF-");
}

}  // namespace
}  // namespace sightline

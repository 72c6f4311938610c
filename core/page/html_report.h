#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Builds one self-contained HTML page: no network, no other file, the same bytes for the same data. For
// example
//
//   HtmlReport page("Bake of city.glb");
//   page.text("What can be seen from three view cells.");
//   page.section("Cells");
//   page.table({.columns = {"cell", "triangles", "share"}, .rows = {{"street-1", "1234", "2.7 %"}}});
//   page.section("Convergence");
//   ReportChart chart{.title = "Set size over rays", .x = "rays", .y = "triangles", .log_x = true};
//   chart.series.push_back({.name = "street-1", .points = {{1e6, 900}, {2e6, 1234}}});
//   page.charts({chart});
//   page.section("Pictures");
//   page.pictures({{.png = encodePng(image), .caption = "street-1 from outside"}});
//   page.repeat({.command = commandLine(), .seed = "1", .device = "cpu", .driver = "built in", .version =
//   "0.1"}); page.save("bake.html");
//
// All text is taken as text: names of scenes and cells cannot break the page. It is made for a phone, a
// desktop and paper; charts are drawn by Chart.js from the tables of their data, which readers find below
// them.
namespace sightline {

/// A name and a value, as text.
using ReportFact = std::pair<std::string, std::string>;

struct ReportTable {
  std::string caption = {};  ///< empty: none
  std::vector<std::string> columns = {};
  std::vector<std::vector<std::string>> rows = {};  ///< each as long as columns
  size_t text_columns = 1;   ///< the first so many are text, to the left; the rest are numbers
  bool short_names = false;  ///< the first column holds words of a few letters, in which no line may break
};

struct ChartPoint {
  double x = 0, y = 0;
};

struct ChartSeries {
  std::string name = {};
  std::vector<ChartPoint> points = {};  ///< in the order of the line; points that are not finite are left out
  bool dots = false;                    ///< dots without a line
  bool dashed = false;
  bool fills = false;  ///< the area between this line and the series before it is tinted, markers left out
  bool on_demand = false;  ///< not drawn until the reader picks its name, then in a colour that is free
  bool in_legend = true;   ///< a series without belongs to the one of its colour number
  std::optional<uint32_t> color = {};  ///< modulo ten, with its own marker; none: its place in the chart
};

/// Lines over two axes. On a logarithmic axis there is no place for x or y of 0 or below: the line has a gap,
/// the table of the data has the point.
struct ReportChart {
  std::string title = {};
  std::string note = {};       ///< below the title; empty: none
  std::string x = {}, y = {};  ///< what the axes say, with the unit: "seconds"
  bool log_x = false, log_y = false;
  bool stacked = false;  ///< series are parts of a whole, drawn as areas on top of each other, at the same x;
                         ///< the y axis begins at 0
  std::string pick = {};  ///< what the series on demand are: "single cells". Charts beside each other share
                          ///< one list to pick from, by the names of the series
  std::vector<ChartSeries> series = {};
};

/// A part of a span chart's row.
struct ReportSpan {
  std::string name = {};
  double begin = 0, end = 0;
};

/// What happened when: rows of bars over one axis that begins at 0. Parts of the same name have one colour in
/// all rows.
struct ReportSpans {
  std::string title = {};
  std::string note = {};
  std::string unit = {};                                                   ///< of the axis: "ms"
  std::vector<std::pair<std::string, std::vector<ReportSpan>>> rows = {};  ///< name and spans, in their order
};

struct ReportPicture {
  std::vector<uint8_t> png = {};  ///< bytes of a PNG file (encodePng, core/picture/png.h)
  std::string caption = {};
  std::string alt = {};  ///< what one sees, for who does not; empty: the caption
};

/// What one needs to make the page again. Empty values are left out.
struct ReportRepeat {
  std::string command = {};  ///< as a shell takes it
  std::string seed = {}, device = {}, driver = {}, version = {};
};

/// Points of a series that a page draws at most: more cannot be told apart.
inline constexpr size_t kMaxChartPoints = 300;
/// Of a series on demand: there may be hundreds of them.
inline constexpr size_t kMaxOnDemandPoints = 100;

/// The series with at most `most` (2 or more) of its points: the first, the last, and of those between the
/// last one in each of equal parts of the axis (of its logarithm). A line of points in ascending x keeps its
/// shape.
std::vector<ChartPoint> thinned(std::span<const ChartPoint> points, bool log_x,
                                size_t most = kMaxChartPoints);

/// Pictures in a row that are drawn large.
inline constexpr size_t kLargePictures = 16;

class HtmlReport {
 public:
  explicit HtmlReport(std::string title);

  /// Begins a section; there is a list of them at the top.
  void section(std::string_view title);
  /// A paragraph.
  void text(std::string_view paragraph);
  /// Names and values, in columns.
  void facts(std::span<const ReportFact> facts);
  /// Throws std::invalid_argument if a row has not as many cells as there are columns.
  void table(const ReportTable& table);
  /// Charts beside each other where there is room. Series are thinned to kMaxChartPoints, or
  /// kMaxOnDemandPoints.
  void charts(std::span<const ReportChart> charts);
  void spans(const ReportSpans& chart);
  /// Beside each other where there is room; more than kLargePictures are small until the reader enlarges one.
  void pictures(std::span<const ReportPicture> pictures);
  /// A section that says how to make the page again.
  void repeat(const ReportRepeat& repeat);

  void facts(std::initializer_list<ReportFact> list) { facts(std::span(list.begin(), list.size())); }
  void charts(std::initializer_list<ReportChart> list) { charts(std::span(list.begin(), list.size())); }
  void pictures(std::initializer_list<ReportPicture> list) { pictures(std::span(list.begin(), list.size())); }

  /// The whole page.
  std::string html() const;
  /// Writes it, under its name when it is complete (OutputFile). Throws Error.
  void save(const std::filesystem::path& file) const;

 private:
  std::string title_;
  std::vector<std::string> sections_;
  std::string body_;
};

}  // namespace sightline

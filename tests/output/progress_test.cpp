#include "core/bake/progress.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/bake/cell_table.h"
#include "core/base/text.h"
#include "tests/output/example_pvs.h"

namespace sightline {
namespace {

/// What a printer writes to a stream of its own.
class Output {
 public:
  Output() : stream_(::open_memstream(&text_, &size_)) {}
  ~Output() {
    std::fclose(stream_);
    std::free(text_);
  }
  std::FILE* stream() { return stream_; }
  std::string text() {
    std::fflush(stream_);
    return std::string(text_, size_);
  }

 private:
  char* text_ = nullptr;
  size_t size_ = 0;
  std::FILE* stream_;
};

BakeProgress at(double seconds) {
  return {.iteration = 3,
          .stage = kStageBorder,
          .rays = 12'300'000,
          .pvs_size = 12345,
          .new_triangles = 17,
          .seconds = seconds,
          .seconds_left = 10};
}

std::vector<ViewCell> threeCells() {
  return examplePvs().planned;
}

size_t count(const std::string& text, char c) {
  return size_t(std::count(text.begin(), text.end(), c));
}

TEST(Text, CountsAndDurationsAreShort) {
  EXPECT_EQ(counted(0, "cell") + counted(1, "cell") + counted(2, "cell"), "0 cells1 cell2 cells");
  EXPECT_EQ(shortCount(0), "0");
  EXPECT_EQ(shortCount(999), "999");
  EXPECT_EQ(shortCount(1000), "1.00k");
  EXPECT_EQ(shortCount(12'345), "12.3k");
  EXPECT_EQ(shortCount(999'499), "999k");
  EXPECT_EQ(shortCount(999'999), "1.00M");
  EXPECT_EQ(shortCount(10'000'000'000), "10.0G");
  EXPECT_EQ(shortCount(UINT64_MAX), "18.4E");
  EXPECT_EQ(shortDuration(0.44), "0.4 s");
  EXPECT_EQ(shortDuration(59.6), "1 min 00 s");
  EXPECT_EQ(shortDuration(185), "3 min 05 s");
  EXPECT_EQ(shortDuration(7620), "2 h 07 min");
  EXPECT_EQ(shortDuration(-1), "?");
  EXPECT_EQ(shortDuration(1.0 / 0.0), "?");
}

TEST(Progress, LineSaysEverything) {
  EXPECT_EQ(progressLine("street-1", 1, 10, at(2), 190),
            "street-1 2/10  it 3 border  12.3M rays  PVS 12345 +17  left 0:10, all 3:10  6.15 Mrays/s");
}

TEST(Progress, LineSaysHowSureTheTimeLeftIs) {
  const auto line = [](const BakeProgress& progress, double all) {
    const std::string text = progressLine("a", 0, 2, progress, all);
    const size_t begin = text.find("left");
    return text.substr(begin, text.find("  ", begin) - begin);
  };
  BakeProgress progress = at(2);
  progress.at_least = true;
  EXPECT_EQ(line(progress, 190), "left >0:10, all >3:10");
  progress.at_least = false;
  progress.seconds_left_from = 4;
  progress.seconds_left_to = 75;
  EXPECT_EQ(line(progress, 190), "left 0:04-1:15, all 3:04-4:15");
  progress.seconds_left_from = progress.seconds_left_to = 10.2;
  EXPECT_EQ(line(progress, 190), "left 0:10, all 3:10");
  progress.seconds_left = -1;
  EXPECT_EQ(line(progress, 190), "left ?, all 3:10") << "by the cells before";
  EXPECT_EQ(line(progress, -1), "left ?, all ?");
  progress = at(2);
  progress.seconds_left = 1e300;
  EXPECT_EQ(line(progress, 1e300), "left ?, all ?");
}

TEST(Progress, PlainLinesComeAtTheStartEveryFewSecondsAndAtTheEnd) {
  Output out;
  ProgressPrinter printer(out.stream(), 0, threeCells());
  for (double seconds = 0; seconds < 11; seconds += 0.25) printer.progress(0, at(seconds));
  EXPECT_EQ(count(out.text(), '\n'), 3u);  // at 0, 5 and 10 seconds
  printer.cellDone(0, summarize(exampleCell(threeCells()[0], {1, 2}, false)));
  printer.progress(1, at(0));
  EXPECT_EQ(count(out.text(), '\n'), 5u);
  EXPECT_EQ(count(out.text(), '\r'), 0u);
  EXPECT_EQ(count(out.text(), '\x1b'), 0u);
}

TEST(Progress, TerminalLineIsRewrittenAndNeverWraps) {
  Output out;
  ProgressPrinter printer(out.stream(), 40, threeCells());
  for (double seconds = 0; seconds < 3; seconds += 0.2) printer.progress(1, at(seconds));
  EXPECT_EQ(count(out.text(), '\n'), 0u);
  EXPECT_GE(count(out.text(), '\r'), 10u);
  printer.cellDone(1, summarize(exampleCell(threeCells()[1], {1, 2}, false)));
  EXPECT_EQ(count(out.text(), '\n'), 1u);
  printer.breakLine();  // no line is open
  EXPECT_EQ(count(out.text(), '\n'), 1u);
  size_t begin = 0;
  const std::string text = out.text();
  for (size_t end; (end = text.find('\r', begin)) != std::string::npos; begin = end + 1) {
    size_t shown = 0;
    for (size_t i = begin; i < end; ++i) shown += (text[i] & 0xc0) != 0x80;
    EXPECT_LE(shown, 39u + 3u);  // and the three characters that clear the rest of the line
  }
}

TEST(Progress, ANarrowTerminalShortensTheNameAndKeepsTheTimeLeft) {
  Output out;
  std::vector<ViewCell> cells = threeCells();
  cells[0].name = "a-street-with-a-long-name";
  ProgressPrinter printer(out.stream(), 80, cells);
  printer.progress(0, at(2));
  EXPECT_EQ(out.text(),
            "\ra-st~ 1/3 it 3 border 12.3M rays PVS 12345 +17 left 0:10, all 0:34 6.15 Mrays/s\x1b[K");
}

TEST(Progress, ANarrowerTerminalLeavesOutWholeFieldsAndCutsNoNumber) {
  for (uint32_t columns = 64; columns < 77; ++columns) {
    Output out;
    ProgressPrinter printer(out.stream(), columns, threeCells());
    BakeProgress progress = at(2);
    progress.rays = 123'000'000'000;
    printer.progress(0, progress);
    EXPECT_NE(out.text().find("border 123G rays PVS 12345 +17 left 0:10, all 0:34\x1b[K"), std::string::npos)
        << out.text();
  }
}

TEST(Progress, TimeLeftCountsFinishedCells) {
  Output out;
  CellSummary finished = summarize(exampleCell(threeCells()[0], {1}, false));
  finished.stats.seconds = 30;
  ProgressPrinter printer(out.stream(), 0, threeCells(), std::vector{finished});
  printer.progress(1, at(20));  // 20 + 10 s for this one, mean 30 s, one more to come
  EXPECT_NE(out.text().find("left 0:10, all 0:40"), std::string::npos) << out.text();
}

TEST(Progress, TableHasALineACellAndStraightColumns) {
  std::vector<CellSummary> cells = summarize(examplePvs());
  cells[0].stats.validation_rays = 0;
  const std::string table = cellTable(cells, 1000);
  EXPECT_EQ(count(table, '\n'), 3u);
  EXPECT_NE(table.find("not measured"), std::string::npos);
  EXPECT_NE(table.find("0.70 %"), std::string::npos);
  EXPECT_NE(table.find("0.002 (< 0.011)"), std::string::npos);
  EXPECT_NE(table.find("ray limit"), std::string::npos);
}

}  // namespace
}  // namespace sightline

#include "core/path/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/formats/walk_file.h"

namespace sightline {
namespace {

using Keys = std::vector<PathKey>;

CameraPath evenPath(std::vector<uint32_t> cuts = {}) {
  CameraPath path;
  path.keys = {{0, {{0, 0, 0}, {1, 0, 0}}},
               {10, {{1, 2, 3}, {4, 1, 0}}},
               {20, {{5, 2, -1}, {9, 0, 0}}},
               {30, {{6, 7, 8}, {6, 7, 20}}}};
  path.cuts = std::move(cuts);
  return path;
}

/// Catmull and Rom's cubic between b and c as textbooks have it, keys at even distances.
glm::dvec3 textbook(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d, double t) {
  return 0.5 * (2.0 * b + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * (t * t) +
                (3.0 * b - a - 3.0 * c + d) * (t * t * t));
}

TEST(CameraPath, IsThatOfTheTextbookWhereKeysAreEven) {
  const CameraPath path = evenPath();
  ASSERT_FALSE(pathProblem(path));
  EXPECT_EQ(path.frames(), 31u);
  for (uint32_t frame = 10; frame <= 20; ++frame) {
    const auto& k = path.keys;
    const double t = (frame - 10) / 10.0;
    const PathPlace at = placeAt(path, frame);
    EXPECT_LT(glm::length(at.eye - textbook(k[0].at.eye, k[1].at.eye, k[2].at.eye, k[3].at.eye, t)), 1e-12);
    EXPECT_LT(glm::length(at.look - textbook(k[0].at.look, k[1].at.look, k[2].at.look, k[3].at.look, t)),
              1e-12);
  }
  for (const PathKey& key : path.keys) EXPECT_EQ(placeAt(path, key.frame), key.at);
}

TEST(CameraPath, IsSmoothWhereKeysAreUneven) {
  CameraPath path = evenPath();
  path.keys[1].frame = 1000;
  path.keys[2].frame = 1500;
  path.keys[3].frame = 4000;
  for (uint32_t frame = 1; frame + 1 < path.frames(); ++frame) {
    const glm::dvec3 before = placeAt(path, frame).eye - placeAt(path, frame - 1).eye;
    const glm::dvec3 after = placeAt(path, frame + 1).eye - placeAt(path, frame).eye;
    ASSERT_LT(glm::length(after - before), 2e-4) << frame;
  }
}

TEST(CameraPath, JumpsAtACutAndBorrowsNothingFromBehindIt) {
  const CameraPath path = evenPath({20});
  EXPECT_EQ(placeAt(path, 19), path.keys[1].at);  // it stands
  EXPECT_EQ(placeAt(path, 20), path.keys[2].at);
  EXPECT_TRUE(startsStretch(path, 0) && startsStretch(path, 20));
  EXPECT_FALSE(startsStretch(path, 19) || startsStretch(path, 21));
  CameraPath other = path;
  other.keys[2].at.eye = {100, 100, 100};
  other.keys[3].at.eye = {-100, 100, 100};
  for (uint32_t frame = 0; frame < 20; ++frame) EXPECT_EQ(placeAt(path, frame), placeAt(other, frame));
  // Two keys alone are a straight line.
  EXPECT_LT(glm::length(placeAt(path, 25).eye - 0.5 * (path.keys[2].at.eye + path.keys[3].at.eye)), 1e-12);
}

TEST(CameraPath, RestsBetweenEqualPlaces) {
  CameraPath path = evenPath();
  path.keys[2].at.eye = path.keys[1].at.eye;
  for (uint32_t frame = 10; frame <= 20; ++frame) EXPECT_EQ(placeAt(path, frame).eye, path.keys[1].at.eye);
  EXPECT_NE(placeAt(path, 15).look, path.keys[1].at.look);
}

std::string problemOf(const CameraPath& path) {
  const auto problem = pathProblem(path);
  return problem ? problem->place + ": " + problem->what : "";
}

TEST(CameraPath, NamesWhatIsWrong) {
  const auto with = [](auto change) {
    CameraPath path = evenPath();
    change(path);
    return problemOf(path);
  };
  EXPECT_EQ(with([](CameraPath& p) { p.keys.clear(); }), "keys: is empty; at least one key is needed");
  EXPECT_EQ(with([](CameraPath& p) { p.keys[0].frame = 1; }),
            "keys[0].frame: is 1; the first key is at frame 0");
  EXPECT_EQ(with([](CameraPath& p) { p.keys[2].frame = 10; }),
            "keys[2].frame: 10 is not above 10, the frame of the key before it");
  EXPECT_EQ(with([](CameraPath& p) { p.keys[3].frame = 1'000'000; }),
            "keys[3].frame: is past 999999, the last frame that a path may have");
  EXPECT_EQ(with([](CameraPath& p) { p.keys[3].frame = 999'999; }), "");
  EXPECT_EQ(with([](CameraPath& p) { p.keys[1].at.eye.y = NAN; }), "keys[1].eye[1]: is not a finite number");
  EXPECT_EQ(with([](CameraPath& p) { p.keys[1].at.look.z = 1e300; }),
            "keys[1].look[2]: 1e+300 is farther than 2^40 from the origin");
  EXPECT_EQ(with([](CameraPath& p) { p.keys[2].at.look = p.keys[2].at.eye; }),
            "keys[2].look: is the eye's place; there is nothing to look at");
  EXPECT_EQ(with([](CameraPath& p) { p.fov = 0; }), "fov: 0 is not between 1 and 179 degrees");
  EXPECT_EQ(with([](CameraPath& p) { p.fov = NAN; }), "fov: nan is not between 1 and 179 degrees");
  EXPECT_EQ(with([](CameraPath& p) { p.cuts = {11}; }),
            "cuts[0]: there is no key at frame 11 that the camera could jump to");
  EXPECT_EQ(with([](CameraPath& p) { p.cuts = {0}; }),
            "cuts[0]: there is no key at frame 0 that the camera could jump to");
  EXPECT_EQ(with([](CameraPath& p) { p.cuts = {20, 10}; }), "cuts[1]: 10 is not above 20, the cut before it");
  const CameraPath meeting{.keys = {{0, {{0, 0, 0}, {2, 0, 0}}}, {2, {{2, 0, 0}, {0, 0, 0}}}}, .cuts = {}};
  EXPECT_EQ(problemOf(meeting),
            "keys[0]: in frame 1, after it, the eye is where it looks; move a look point away from the path");
}

TEST(PathThrough, GoesAlongLinesAtAnEvenSpeed) {
  const std::vector<glm::dvec3> points = {{0, 2, 0}, {100, 2, 0}, {100, 2, 0}, {100, 2, 50}, {100, 2, 0}};
  const CameraPath path = pathThrough({.points = points, .frames = 2001});
  ASSERT_FALSE(pathProblem(path));
  ASSERT_EQ(path.frames(), 2001u);
  EXPECT_EQ(placeAt(path, 0).eye, points[0]);
  EXPECT_EQ(placeAt(path, 2000).eye, points[4]);
  for (uint32_t frame = 0; frame < 2000; ++frame) {
    const PathPlace a = placeAt(path, frame), b = placeAt(path, frame + 1);
    const double step = glm::length(b.eye - a.eye);
    EXPECT_LT(step, 0.14) << frame;
    // The middle of a line: straight ahead, at 200 metres in 2000 frames.
    const double way = frame * 0.1;
    if (way < 93 || (way > 104 && way < 146) || (way > 154)) {
      EXPECT_NEAR(step, 0.1, 5e-3) << frame;
    }
    if (way > 12.6 && way < 87) {
      EXPECT_LT(glm::length(a.look - a.eye - glm::dvec3(1, 0, 0)), 1e-9) << frame;
    }
    EXPECT_GT(glm::length(a.look - a.eye), 0.3) << frame;
    // Near one of the lines.
    const double off_first = std::fabs(a.eye.z), off_second = std::fabs(a.eye.x - 100);
    EXPECT_LT(std::min(off_first, off_second), 0.6) << frame;
    EXPECT_NEAR(a.eye.y, 2, 1e-12);
  }
}

TEST(PathThrough, LeavesOutTheLineOfACut) {
  const std::vector<glm::dvec3> points = {{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {30, 0, 0}};
  const CameraPath path = pathThrough({.points = points, .frames = 31, .cuts = {15}});
  EXPECT_EQ(placeAt(path, 14).eye, points[1]);
  EXPECT_EQ(placeAt(path, 15).eye, points[2]);
  EXPECT_EQ(placeAt(path, 30).eye, points[3]);
  EXPECT_EQ(path.cuts, std::vector<uint32_t>{15});
  // On the last line: what is left is its end.
  const CameraPath last = pathThrough({.points = points, .frames = 31, .cuts = {25}});
  EXPECT_EQ(placeAt(last, 25).eye, points[3]);
  EXPECT_EQ(placeAt(last, 30).eye, points[3]);
}

std::string refusal(PathThrough wanted) {
  try {
    pathThrough(wanted);
  } catch (const Error& error) {
    EXPECT_EQ(error.exitCode(), kExitUsage);
    return error.what();
  }
  return "";
}

TEST(PathThrough, RefusesWhatIsNoPath) {
  const std::vector<glm::dvec3> points = {{0, 0, 0}, {10, 0, 0}, {20, 0, 0}};
  EXPECT_EQ(refusal({.points = {{1, 1, 1}, {1, 1, 1}}, .frames = 10}),
            "path: takes two different points or more");
  EXPECT_EQ(refusal({.points = points, .frames = 1}), "path: 1 frames is not between 2 and 1000000");
  EXPECT_EQ(refusal({.points = points, .frames = 2}),
            "path: 2 frames are too few for 3 points; give more --frames");
  EXPECT_EQ(refusal({.points = points, .frames = 3}), "");
  EXPECT_EQ(refusal({.points = {{0, 0, 0}, {NAN, 0, 0}}, .frames = 10}), "path: point 2 is not finite");
  EXPECT_EQ(refusal({.points = points, .frames = 30, .cuts = {30}}),
            "path: a cut at frame 30 is not between frames 0 and 30");
  EXPECT_EQ(refusal({.points = points, .frames = 30, .cuts = {3, 5}}),
            "path: the cut at frame 5 is on the same line as the one before");
}

TEST(WalkFile, ReadsBackWhatItWrites) {
  CameraPath path = evenPath({10, 20});
  path.fov = 77.25;
  path.keys[1].at.eye = {0.1, -1e-300, 123456.789012345};
  EXPECT_EQ(parseWalk(walkText(path, "w.json"), "w.json"), path);
  const CameraPath plain =
      parseWalk(R"({"keys":[{"frame":0,"eye":[0,1,2],"look":[3,4,5],"x-note":1}],"x-by":"hand"})", "w.json");
  EXPECT_EQ(plain.fov, 60);
  EXPECT_EQ(plain.keys, (Keys{{0, {{0, 1, 2}, {3, 4, 5}}}}));
}

std::string readError(std::string_view text) {
  try {
    parseWalk(text, "w.json");
  } catch (const Error& error) {
    EXPECT_EQ(error.exitCode(), kExitUsage) << error.what();
    return error.what();
  }
  return "";
}

TEST(WalkFile, NamesFileAndPlaceOfWhatIsWrong) {
  EXPECT_EQ(readError(""), R"(w.json: is empty, expected {"keys":[...]})");
  EXPECT_EQ(readError("{}"), R"(w.json: key "keys" is missing)");
  EXPECT_EQ(readError("[]"), "w.json: expected an object");
  EXPECT_EQ(readError(R"({"keys":[]})"), "w.json: keys: is empty; at least one key is needed");
  EXPECT_EQ(readError(R"({"keys":[{"frame":0,"eye":[0,0,0]}]})"),
            R"(w.json: keys[0]: key "look" is missing)");
  EXPECT_EQ(readError(R"({"keys":[{"frame":-1,"eye":[0,0,0],"look":[1,0,0]}]})"),
            "w.json: keys[0].frame: expected a whole number of at least 0");
  EXPECT_EQ(readError(R"({"keys":[{"frame":0,"eye":[0,0],"look":[1,0,0]}]})"),
            "w.json: keys[0].eye: expected 3 numbers");
  EXPECT_EQ(
      readError(R"({"kyes":[]})"),
      R"(w.json: unknown key "kyes", expected one of fov, keys, cuts, or x-... for keys of other programs)");
  EXPECT_NE(readError(R"({"keys":[{"frame":0,"eye":[NaN,0,0],"look":[1,0,0]}]})").find("w.json:1:"),
            std::string::npos);
  EXPECT_EQ(readError(R"({"keys":[{"frame":0,"eye":[1,0,0],"look":[1,0,0]}]})"),
            "w.json: keys[0].look: is the eye's place; there is nothing to look at");
  EXPECT_EQ(readError(R"({"keys":[{"frame":0,"eye":[1,0,0],"look":[0,0,0]},
                               {"frame":1e9,"eye":[1,0,0],"look":[0,0,0]}]})"),
            "w.json: keys[1].frame: is past 999999, the last frame that a path may have");
}

}  // namespace
}  // namespace sightline

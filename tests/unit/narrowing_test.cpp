// What is rounded to float must be rounded, also where it is looked at in double again at once: verify judges
// the ray that it writes, and measure the view that it draws. GCC 12's vectorizer of straight code takes both
// conversions for none (CMakeLists.txt turns it off).
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>

#include "core/judge/judge_ray.h"
#include "core/shared/view_ray.h"

namespace sightline {
namespace {

/// A double that is a float's.
double narrow(double value) {
  const volatile float rounded = static_cast<float>(value);
  return rounded;
}

void expectNarrow(const glm::dvec3& actual, const glm::dvec3& value) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(actual[i], narrow(value[i])) << "component " << i;
}

class Narrowing : public testing::Test {
 protected:
  glm::dvec3 point() { return {number_(random_), number_(random_), number_(random_)}; }

 private:
  std::mt19937_64 random_{11};
  std::uniform_real_distribution<double> number_{-100, 100};
};

[[gnu::noinline]] glm::dvec3 roundedVector(const glm::dvec3& v) {
  return glm::dvec3(glm::vec3(v));
}

TEST_F(Narrowing, OfAVector) {
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 v = point();
    expectNarrow(roundedVector(v), v);
  }
}

[[gnu::noinline]] JudgeRay rayFromTo(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::vec3 origin(from), direction(to - from);
  return judgeRay({glm::vec4(origin, 0), glm::vec4(direction, 0)});
}

TEST_F(Narrowing, OfARayThatIsJudged) {
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 from = point(), to = point();
    const JudgeRay ray = rayFromTo(from, to);
    expectNarrow(ray.origin, from);
    expectNarrow(ray.direction, to - from);
  }
}

struct SeenFrom {
  glm::dvec3 origin, forward;
};

[[gnu::noinline]] SeenFrom viewFrom(const glm::dvec3& origin, const glm::dvec3& target) {
  const ViewFrame frame{glm::vec4(origin, 0), glm::vec4(target - origin, 0), {}, {}};
  return {glm::dvec3(frame.origin), glm::dvec3(frame.forward)};
}

TEST_F(Narrowing, OfAViewThatIsDrawn) {
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 origin = point(), target = point();
    const SeenFrom view = viewFrom(origin, target);
    expectNarrow(view.origin, origin);
    expectNarrow(view.forward, target - origin);
  }
}

/// What is compiled with that vectorizer all the same.
TEST(FloatSources, KnowNoDoubles) {
  const std::filesystem::path root = SL_SOURCE_DIR;
  std::ifstream list(root / "CMakeLists.txt");
  const std::string cmake((std::istreambuf_iterator<char>(list)), {});
  const std::string start = "set(float_sources ";
  const size_t at = cmake.find(start);
  ASSERT_NE(at, std::string::npos);
  std::istringstream names(cmake.substr(at + start.size(), cmake.find(')', at) - at - start.size()));
  for (std::string name; names >> name;) {
    std::ifstream file(root / name);
    const std::string source((std::istreambuf_iterator<char>(file)), {});
    EXPECT_FALSE(source.empty()) << name;
    for (const char* word : {"double", "dvec"}) EXPECT_EQ(source.find(word), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace sightline

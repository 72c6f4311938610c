// The table of parameters: all that follows from it has every field.
#include "core/pvs/param_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/bake/bake.h"
#include "core/bake/bake_page.h"
#include "core/bake/report_json.h"
#include "core/pvs/pvs_sections.h"
#include "tests/output/example_pvs.h"

namespace sightline {
namespace {

/// Calls check(param, changed) for each field, with parameters in which it alone has another value.
template <typename Check>
void forEachChange(const BakeParams& params, Check&& check) {
  for (const Param& param : kParams) {
    SCOPED_TRACE(param.name);
    BakeParams changed = params;
    std::visit(
        [&](const auto& field) {
          auto& value = changed.*field.member;
          value = value == field.low ? field.high : field.low;
        },
        param.field);
    check(param, changed);
  }
}

TEST(ParamTable, NamesEachFieldOnce) {
  std::set<std::string> names, labels;
  forEachChange({}, [&](const Param& param, const BakeParams& changed) {
    EXPECT_NE(changed, BakeParams());
    for (const Param& other : kParams) EXPECT_EQ(sameValue(other, {}, changed), &other != &param);
    EXPECT_TRUE(names.insert(param.name).second);
    EXPECT_TRUE(labels.insert(param.label).second);
    EXPECT_LE(param.since, kPvsVersion);
  });
}

TEST(ParamTable, TheFileHoldsEachField) {
  PvsFile pvs = examplePvs();
  const Bytes before = writeHeadPayload(pvs);
  forEachChange(pvs.params, [&](const Param& param, const BakeParams& changed) {
    PvsFile other = pvs;
    other.params = changed;
    const Bytes bytes = writeHeadPayload(other);
    // What is off by default is not written, in an older version: existing files do not change.
    const bool is_optional = param.since > versionOf(pvs);
    EXPECT_EQ(bytes.size(),
              before.size() + (is_optional ? (param.since - versionOf(pvs)) * sizeof(float) : 0));
    EXPECT_EQ(versionOf(other), is_optional ? param.since : versionOf(pvs));
    EXPECT_NE(bytes, before);
    EXPECT_EQ(readHeadPayload(bytes, versionOf(other)).params, changed);
  });
}

TEST(ParamTable, AResumeNamesEachDifference) {
  const PvsFile pvs = examplePvs();
  forEachChange(pvs.params, [&](const Param& param, const BakeParams& changed) {
    PvsFile other = pvs;
    other.params = changed;
    EXPECT_EQ(inputDifferences(pvs, other),
              std::vector<std::string>{std::string(param.name) + " (" + valueText(param, pvs.params) +
                                       " there, " + valueText(param, changed) + " now)"});
  });
}

TEST(ParamTable, JsonHasEachFieldButTheSeed) {
  EXPECT_EQ(toJson(BakeParams()).size(), std::size(kParams) - 1);
  forEachChange({}, [](const Param& param, const BakeParams& changed) {
    const bool seed = std::string(param.name) == "seed";
    const Json before = toJson(BakeParams()), after = toJson(changed);
    EXPECT_EQ(after.contains(param.name), !seed);
    EXPECT_EQ(before == after, seed);
  });
}

TEST(ParamTable, ThePageHasEachFieldOfItsMethods) {
  const auto valueOf = [](const Param& param, const BakeParams& params) {
    for (const auto& [name, value] : parameterFacts(params)) {
      const bool drawn = name == "samples an iteration";  // n_rand of the method raster
      if (drawn ? std::string(param.name) == "n_rand" : name == param.label) return value;
    }
    return std::string("not there");
  };
  forEachChange({}, [&](const Param& param, BakeParams changed) {
    for (const Method method :
         {Method::kGvspp, Method::kGvs, Method::kRandom, Method::kRaster, Method::kNaive}) {
      BakeParams before;
      before.method = changed.method = method;
      const bool is_method = std::string(param.name) == "method";
      EXPECT_EQ(valueOf(param, changed) != "not there", isUsedBy(param, method));
      EXPECT_EQ(valueOf(param, before) != valueOf(param, changed), isUsedBy(param, method) && !is_method);
    }
  });
}

TEST(ParamTable, ValuesOutOfTheirRangeAreRefused) {
  EXPECT_EQ(paramProblem({}), "");
  const auto problem = [](auto change) {
    BakeParams params;
    change(params);
    return paramProblem(params);
  };
  EXPECT_EQ(problem([](BakeParams& p) { p.n_rand = 0; }), "n-rand must be 1 .. 4294967293");
  EXPECT_EQ(problem([](BakeParams& p) { p.n_rand = 4294967294; }), "n-rand must be 1 .. 4294967293");
  EXPECT_EQ(problem([](BakeParams& p) { p.reverse_stride = 0; }), "reverse-stride must be at least 1");
  EXPECT_EQ(problem([](BakeParams& p) { p.delta_rs = -1; }), "delta-rs must be finite and not negative");
  EXPECT_EQ(problem([](BakeParams& p) { p.abs_spacing = NAN; }),
            "abs-spacing must be finite and not negative");
  EXPECT_EQ(problem([](BakeParams& p) { p.max_seconds = INFINITY; }),
            "max-seconds must be finite and not negative");
  EXPECT_EQ(problem([](BakeParams& p) { p.target_error = 1; }),
            "target-error must be 0 (off) or 1e-10 .. 0.999999");
  EXPECT_EQ(problem([](BakeParams& p) { p.target_error = 1e-11; }),
            "target-error must be 0 (off) or 1e-10 .. 0.999999");
  EXPECT_EQ(problem([](BakeParams& p) { p.target_error = 0.5; }), "");
  EXPECT_EQ(problem([](BakeParams& p) { p.method = Method(6); }),
            "method must be gvs++, gvs, random, raster, naive, bound");
  EXPECT_EQ(problem([](BakeParams& p) { p.order = Order(2); }), "order must be queue, yield");
  // Both ends of each are good.
  for (const Param& param : kParams) {
    BakeParams low, high;
    std::visit([&](const auto& field) { low.*field.member = field.low, high.*field.member = field.high; },
               param.field);
    EXPECT_EQ(paramProblem(low) + paramProblem(high), "") << param.name;
  }
}

std::string textOfFile(const std::string& name) {
  const auto bytes = readBytes(std::string(SL_SOURCE_DIR "/docs/") + name);
  return std::string(bytes.begin(), bytes.end());
}

/// docs/parameters.md's table, as the program knows it.
std::string documentTable() {
  std::string text =
      "| parameter | option | values | unit | default | methods | meaning |\n| --- | --- | --- | --- | --- | "
      "--- | "
      "--- |\n";
  for (const Param& param : kParams) {
    std::string methods;
    for (uint32_t i = 0; i <= uint32_t(Method::kNaive); ++i) {
      if (isUsedBy(param, Method(i))) methods += (methods.empty() ? "" : ", ") + methodName(Method(i));
    }
    if (param.methods == kEveryMethod) methods = "all";
    text += std::string("| `") + param.name + "` | `" + optionOf(param) + "` | " + rangeText(param) + " | " +
            param.unit + " | " + valueText(param, {}) + " | " + methods + " | " + param.help + " |\n";
  }
  return text;
}

TEST(ParamTable, DocumentsNameEachParameter) {
  EXPECT_NE(textOfFile("parameters.md").find(documentTable()), std::string::npos)
      << "docs/parameters.md should have this table:\n"
      << documentTable();
  for (const char* name : {"pvs-format.md", "report.md"}) {
    const std::string text = textOfFile(name);
    for (const Param& param : kParams) {
      const bool named = text.find(std::string("`") + param.name + "`") != std::string::npos;
      EXPECT_TRUE(named) << name << " lacks " << param.name;
    }
  }
}

}  // namespace
}  // namespace sightline

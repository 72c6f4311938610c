#include "core/formats/json_edit.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

namespace sightline {
namespace {

using nlohmann::json;

const std::string kText =
    "\xef\xbb\xbf {\"a\" : [ 1, {\"x\\\"]\": \"}\\\\\"} , [] ],\n \"b\":{ }, \"c\" : -1.5e3 }\n";

std::string textOf(JsonSpan span) {
  return kText.substr(span.begin, span.end - span.begin);
}

TEST(JsonEdit, FindsValuesInTheText) {
  const JsonSpan root = jsonRoot(kText);
  EXPECT_EQ(textOf(root), kText.substr(4, kText.size() - 5));
  const auto members = jsonMembers(kText, root);
  ASSERT_EQ(members.size(), 3u);
  EXPECT_EQ(members[2].key, "c");
  EXPECT_EQ(textOf(members[2].value), "-1.5e3");
  const auto elements = jsonElements(kText, members[0].value);
  ASSERT_EQ(elements.size(), 3u);
  EXPECT_EQ(textOf(elements[1]), "{\"x\\\"]\": \"}\\\\\"}");
  EXPECT_EQ(jsonMembers(kText, elements[1])[0].key, "x\"]");
  EXPECT_TRUE(jsonElements(kText, elements[2]).empty());
  EXPECT_FALSE(jsonMember(kText, root, "d"));
}

TEST(JsonEdit, LeavesEverythingElseAsItIs) {
  const JsonSpan root = jsonRoot(kText);
  JsonEdits edits(kText);
  edits.setMembers(root, {{"b", "7"}, {"d", "[true]"}});
  EXPECT_EQ(edits.apply(),
            "\xef\xbb\xbf {\"a\" : [ 1, {\"x\\\"]\": \"}\\\\\"} , [] ],\n \"b\":7, \"c\" : "
            "-1.5e3,\"d\":[true] }\n");
}

/// An object of members k0, k1, ... with blanks here and there.
std::string objectText(size_t members, std::mt19937& random) {
  std::string text = random() % 2 ? "{ " : "{";
  for (size_t i = 0; i < members; ++i) {
    text += (i == 0 ? "" : random() % 2 ? " ,\n" : ",") + std::string("\"k") + std::to_string(i) + "\": ";
    text += random() % 2 ? "[1,2]" : "\"}{,\"";
  }
  return text + (random() % 2 ? " }" : "}");
}

TEST(JsonEdit, SetsAndRemovesAnyMembers) {
  std::mt19937 random(1);
  for (int round = 0; round < 2000; ++round) {
    const std::string text = objectText(random() % 5, random);
    std::map<std::string, std::optional<std::string>> values;
    json expected = json::parse(text);
    for (size_t i = 0; i < 7; ++i) {
      const std::string key = "k" + std::to_string(i);
      if (random() % 3 == 0) {
        values[key] = std::nullopt;
        expected.erase(key);
      } else if (random() % 2 == 0) {
        values[key] = "\"new\"";
        expected[key] = "new";
      }
    }
    JsonEdits edits(text);
    edits.setMembers(jsonRoot(text), values);
    ASSERT_EQ(json::parse(edits.apply()), expected) << text << "\n" << edits.apply();
  }
}

TEST(JsonEdit, RemovesAndAppendsAnyElements) {
  std::mt19937 random(2);
  for (int round = 0; round < 500; ++round) {
    const size_t count = random() % 6;
    std::string text = "[";
    std::vector<size_t> gone;
    json expected = json::array(), longer = json::array();
    for (size_t i = 0; i < count; ++i) {
      text += (i == 0 ? " " : " , ") + std::to_string(i);
      longer.push_back(i);
      if (random() % 2) {
        gone.push_back(i);
      } else {
        expected.push_back(i);
      }
    }
    text += " ]";
    JsonEdits removal(text);
    removal.remove(jsonRoot(text), gone);
    ASSERT_EQ(json::parse(removal.apply()), expected) << removal.apply();
    JsonEdits addition(text);
    addition.append(jsonRoot(text), {"\"x\"", "{}"});
    longer.push_back("x");
    longer.push_back(json::object());
    ASSERT_EQ(json::parse(addition.apply()), longer) << addition.apply();
  }
}

}  // namespace
}  // namespace sightline

#include "core/scene/json_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "core/error.h"

namespace sightline {
namespace {

/// Far more than any file needs; recursion over a document stays harmless.
constexpr int kMaxDepth = 200;

/// The library's words after its own prefix "[...] parse error at line 1, column 2: ".
std::string withoutPrefix(const std::string& message) {
  const size_t column = message.find("column ");
  const size_t colon = message.find(": ", column == std::string::npos ? 0 : column);
  if (colon != std::string::npos) return message.substr(colon + 2);
  const size_t bracket = message.find("] ");
  return bracket == std::string::npos ? message : message.substr(bracket + 2);
}

/// "FILE:LINE:COLUMN" of the byte with that number, counted from 1.
std::string placeOf(std::string_view text, size_t byte, const std::string& file) {
  const std::string_view before = text.substr(0, std::min(text.size(), byte == 0 ? 0 : byte - 1));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const size_t newline = before.rfind('\n');
  const size_t column = before.size() - (newline == std::string_view::npos ? 0 : newline + 1) + 1;
  return fmt::format("{}:{}:{}", file, line, column);
}

}  // namespace

nlohmann::json parseJson(std::string_view text, const std::string& file) {
  using nlohmann::json;
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  const auto watch = [&](int depth, json::parse_event_t event, json& parsed) {
    if (depth > kMaxDepth) {
      throw Error(fmt::format("{}: JSON is nested deeper than {} levels", file, kMaxDepth));
    }
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second) {
      throw Error(fmt::format("{}: key {} occurs twice in one object", file, parsed.dump()));
    }
    return true;
  };
  try {
    return json::parse(text, watch);
  } catch (const json::parse_error& error) {
    throw Error(fmt::format("{}: {}", placeOf(text, error.byte, file), withoutPrefix(error.what())));
  } catch (const json::exception& error) {
    throw Error(fmt::format("{}: {}", file, withoutPrefix(error.what())));
  }
}

}  // namespace sightline

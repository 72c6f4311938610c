#include "core/formats/json_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "core/base/error.h"

namespace sightline {
namespace {

/// Far more than any file needs; recursion over a document stays harmless.
constexpr size_t kMaxDepth = 200;

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

/// Throws for what json::parse lets pass. (Its callback could do that too, but takes quadratic time.)
class StrictReader : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit StrictReader(const std::string& file) : file_(file) {}

  bool start_object(std::size_t) override { return open(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(std::string& name) override {
    if (keys_.back().insert(name).second) return true;
    throw Error(fmt::format("{}: key {} occurs twice in one object", file_, nlohmann::json(name).dump()));
  }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;  // json::parse says where and why
  }

 private:
  bool open() {
    keys_.emplace_back();
    if (keys_.size() <= kMaxDepth) return true;
    throw Error(fmt::format("{}: JSON is nested deeper than {} levels", file_, kMaxDepth));
  }
  bool close() {
    keys_.pop_back();
    return true;
  }

  const std::string& file_;
  std::vector<std::set<std::string>> keys_;  ///< of the objects and lists that are open
};

/// Whether it is how some program prints a number that is none: NaN, -inf, nan(ind), 1.#QNAN, ...
bool isNumberWord(std::string_view token) {
  if (token.starts_with('-') || token.starts_with('+')) token.remove_prefix(1);
  std::string lower(token.substr(0, 16));
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? char(c + 'a' - 'A') : c;
  return token.size() <= 16 && (lower == "nan" || lower == "inf" || lower == "infinity" ||
                                lower.starts_with("nan(") || lower.starts_with("1.#"));
}

/// The text with null in the place of each such word outside of strings, and their number.
std::pair<std::string, uint64_t> withoutNumberWords(std::string_view text) {
  constexpr std::string_view kBetween = " \t\r\n,:[]{}\"";
  std::string result;
  uint64_t words = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (in_string || kBetween.find(c) != std::string_view::npos) {
      if (c == '"') in_string = !in_string;
      const size_t length = in_string && c == '\\' ? 2 : 1;
      result += text.substr(i, length);
      i += length;
      continue;
    }
    const std::string_view token = text.substr(i, text.find_first_of(kBetween, i) - i);
    const bool word = isNumberWord(token);
    result += word ? std::string_view("null") : token;
    words += word ? 1 : 0;
    i += token.size();
  }
  return {std::move(result), words};
}

}  // namespace

nlohmann::json parseJsonWithWords(std::string_view text, const std::string& file, uint64_t& words) {
  words = 0;
  try {
    return parseJson(text, file);
  } catch (const Error&) {
    const auto [changed, found] = withoutNumberWords(text);
    if (found == 0) throw;
    words = found;
    return parseJson(changed, file);
  }
}

nlohmann::json parseJson(std::string_view text, const std::string& file) {
  using nlohmann::json;
  try {
    StrictReader reader(file);
    json::sax_parse(text, &reader);
    return json::parse(text);
  } catch (const json::parse_error& error) {
    throw Error(fmt::format("{}: {}", placeOf(text, error.byte, file), withoutPrefix(error.what())));
  } catch (const json::exception& error) {
    throw Error(fmt::format("{}: {}", file, withoutPrefix(error.what())));
  }
}

}  // namespace sightline

#include "core/formats/json_edit.h"

#include <nlohmann/json.hpp>

namespace sightline {
namespace {

constexpr std::string_view kJsonBlanks = " \t\r\n";

size_t skipBlanks(std::string_view text, size_t at) {
  const size_t found = text.find_first_not_of(kJsonBlanks, at);
  return found == std::string_view::npos ? text.size() : found;
}

/// The end of the string that begins with the quote at `at`.
size_t stringEnd(std::string_view text, size_t at) {
  for (++at; text[at] != '"'; ++at) {
    if (text[at] == '\\') ++at;
  }
  return at + 1;
}

/// The end of the value that begins at `at`.
size_t valueEnd(std::string_view text, size_t at) {
  if (text[at] == '"') return stringEnd(text, at);
  if (text[at] != '{' && text[at] != '[') return std::min(text.find_first_of(",]} \t\r\n", at), text.size());
  size_t depth = 0;
  do {
    const char c = text[at];
    if (c == '"') {
      at = stringEnd(text, at);
      continue;
    }
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    ++at;
  } while (depth != 0);
  return at;
}

/// Whether anything but blanks is between the brackets.
bool isEmpty(std::string_view text, JsonSpan value) {
  return skipBlanks(text, value.begin + 1) == value.end - 1;
}

std::string keyText(const std::string& key) {
  std::string text = nlohmann::json(key).dump();
  text += ':';
  return text;
}

}  // namespace

JsonSpan jsonRoot(std::string_view text) {
  const size_t begin = skipBlanks(text, text.starts_with("\xef\xbb\xbf") ? 3 : 0);
  return {begin, valueEnd(text, begin)};
}

std::vector<JsonSpan> jsonElements(std::string_view text, JsonSpan array) {
  std::vector<JsonSpan> elements;
  size_t at = skipBlanks(text, array.begin + 1);
  while (text[at] != ']') {
    const size_t end = valueEnd(text, at);
    elements.push_back({at, end});
    at = skipBlanks(text, end);
    if (text[at] == ',') at = skipBlanks(text, at + 1);
  }
  return elements;
}

std::vector<JsonMember> jsonMembers(std::string_view text, JsonSpan object) {
  std::vector<JsonMember> members;
  size_t at = skipBlanks(text, object.begin + 1);
  while (text[at] != '}') {
    const size_t key_end = stringEnd(text, at);
    const auto key = nlohmann::json::parse(text.substr(at, key_end - at)).get<std::string>();
    const size_t begin = skipBlanks(text, skipBlanks(text, key_end) + 1);  // behind the colon
    const size_t end = valueEnd(text, begin);
    members.push_back({key, {begin, end}});
    at = skipBlanks(text, end);
    if (text[at] == ',') at = skipBlanks(text, at + 1);
  }
  return members;
}

std::optional<JsonSpan> jsonMember(std::string_view text, JsonSpan object, std::string_view key) {
  for (const JsonMember& member : jsonMembers(text, object)) {
    if (member.key == key) return member.value;
  }
  return std::nullopt;
}

void JsonEdits::replace(JsonSpan value, std::string json) {
  changes_.emplace(value.begin, std::pair(value.end, std::move(json)));
}

void JsonEdits::setMembers(JsonSpan object, const std::map<std::string, std::optional<std::string>>& values) {
  const std::vector<JsonMember> members = jsonMembers(text_, object);
  auto added = values;
  std::vector<JsonSpan> whole;  // with their keys
  std::vector<bool> gone;
  for (const JsonMember& member : members) {
    const size_t from = whole.empty() ? object.begin : whole.back().end;
    const size_t begin = text_.find('"', from);
    whole.push_back({begin, member.value.end});
    const auto value = values.find(member.key);
    gone.push_back(value != values.end() && !value->second);
    if (value != values.end() && value->second) replace(member.value, *value->second);
    added.erase(member.key);
  }
  std::string text;
  bool any_left = std::find(gone.begin(), gone.end(), false) != gone.end();
  for (const auto& [key, value] : added) {
    if (!value) continue;
    if (any_left) text += ',';
    text += keyText(key);
    text += *value;
    any_left = true;
  }
  takeOut(whole, gone);
  const size_t end = whole.empty() ? object.begin + 1 : whole.back().end;
  if (!text.empty()) changes_.emplace(end, std::pair(end, text));
}

void JsonEdits::append(JsonSpan array, const std::vector<std::string>& elements) {
  std::string text;
  bool first = isEmpty(text_, array);
  for (const std::string& element : elements) {
    if (!first) text += ',';
    text += element;
    first = false;
  }
  const std::vector<JsonSpan> there = jsonElements(text_, array);
  const size_t end = there.empty() ? array.begin + 1 : there.back().end;
  if (!text.empty()) changes_.emplace(end, std::pair(end, text));
}

void JsonEdits::remove(JsonSpan array, const std::vector<size_t>& elements) {
  const std::vector<JsonSpan> there = jsonElements(text_, array);
  std::vector<bool> gone(there.size(), false);
  for (const size_t element : elements) gone[element] = true;
  takeOut(there, gone);
}

/// Takes them out with the commas between them and what stays.
void JsonEdits::takeOut(const std::vector<JsonSpan>& values, const std::vector<bool>& gone) {
  bool any_before = false;  // that stays
  for (size_t i = 0; i < values.size();) {
    if (!gone[i]) {
      any_before = true;
      ++i;
      continue;
    }
    size_t behind = i;
    while (behind < values.size() && gone[behind]) ++behind;
    // With the comma before them; where nothing stays before them, with the one behind.
    const size_t begin = any_before ? values[i - 1].end : values[i].begin;
    const size_t end = any_before || behind == values.size() ? values[behind - 1].end : values[behind].begin;
    replace({begin, end}, "");
    i = behind;
  }
}

std::string JsonEdits::apply() const {
  std::string result;
  size_t at = 0;
  for (const auto& [begin, change] : changes_) {
    result.append(text_.substr(at, begin - at)).append(change.second);
    at = change.first;
  }
  return result.append(text_.substr(at));
}

}  // namespace sightline

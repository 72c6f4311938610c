#pragma once
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Changes of single values in the text of a JSON document that leave every other byte as it is. The text must
// be one that parseJsonWithWords takes; nothing is checked again.
namespace sightline {

/// A value's place in a text: bytes begin .. end - 1, without blanks around it.
struct JsonSpan {
  size_t begin = 0;
  size_t end = 0;
};

struct JsonMember {
  std::string key;
  JsonSpan value;
};

/// The document's value: all of the text but blanks and a byte order mark.
JsonSpan jsonRoot(std::string_view text);
/// The elements of the array there.
std::vector<JsonSpan> jsonElements(std::string_view text, JsonSpan array);
/// The members of the object there.
std::vector<JsonMember> jsonMembers(std::string_view text, JsonSpan object);
/// The value of a member of the object there, if it has one of that key.
std::optional<JsonSpan> jsonMember(std::string_view text, JsonSpan object, std::string_view key);

/// Collects changes of a text, which must not overlap, and makes them all at once. Places are those of the
/// text as it was.
class JsonEdits {
 public:
  /// The text must outlive the edits.
  explicit JsonEdits(std::string_view text) : text_(text) {}

  void replace(JsonSpan value, std::string json);
  /// Gives members of the object values: in the place of those that it has, behind the last one if it has
  /// none of that key. Nothing removes the member. Once an object.
  void setMembers(JsonSpan object, const std::map<std::string, std::optional<std::string>>& values);
  /// Adds elements behind the array's last. Once an array.
  void append(JsonSpan array, const std::vector<std::string>& elements);
  /// Takes out the elements with these numbers (ascending). Once an array, and no other change in those.
  void remove(JsonSpan array, const std::vector<size_t>& elements);

  std::string apply() const;

 private:
  void takeOut(const std::vector<JsonSpan>& values, const std::vector<bool>& gone);

  std::string_view text_;
  std::multimap<size_t, std::pair<size_t, std::string>> changes_;  ///< by begin: end, new text
};

}  // namespace sightline

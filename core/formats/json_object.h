#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sightline {

/// A JSON object with its place in a document, for messages: "a.gltf: accessors[3].count: expected ...".
/// Getters throw Error for a value of another type; a missing key, and one whose value is null, gives
/// nothing, or, in the variants that return a plain value without default, an Error.
class JsonObject {
 public:
  /// Throws Error unless `value` is an object. Keeps a reference to it.
  JsonObject(const nlohmann::json& value, std::string file, std::string place);

  bool has(const char* key) const { return find(key) != nullptr; }
  /// In the order of their bytes.
  std::vector<std::string> keys() const;
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

  /// A whole number of at least 0; 12.0 passes as 12.
  std::optional<uint64_t> number(const char* key) const;
  uint64_t requiredNumber(const char* key) const;
  /// An index into a list of `size` elements.
  std::optional<size_t> index(const char* key, size_t size) const;
  size_t requiredIndex(const char* key, size_t size) const;
  bool isNumber(const char* key) const;
  /// Any number.
  std::optional<double> real(const char* key) const;
  std::optional<std::string> text(const char* key) const;
  bool boolean(const char* key, bool value_if_missing) const;
  /// Exactly `size` numbers, or nothing if the key is missing.
  std::optional<std::vector<double>> numbers(const char* key, size_t size) const;
  /// Any count of numbers.
  std::optional<std::vector<double>> numbers(const char* key) const;
  std::vector<size_t> indices(const char* key, size_t size) const;
  std::optional<JsonObject> object(const char* key) const;
  JsonObject requiredObject(const char* key) const;
  /// The list's elements, which must be objects; empty if the key is missing.
  std::vector<JsonObject> objects(const char* key) const;
  std::vector<std::string> texts(const char* key) const;

 private:
  const nlohmann::json* find(const char* key) const;
  const nlohmann::json* list(const char* key) const;
  std::string placeOf(const std::string& key) const;

  const nlohmann::json* value_;
  std::string file_;
  std::string place_;  ///< empty: the document itself
};

}  // namespace sightline

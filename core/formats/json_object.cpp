#include "core/formats/json_object.h"

#include <fmt/format.h>

#include "core/base/error.h"

namespace sightline {
namespace {

using nlohmann::json;

/// A whole number from 0 to 2^53, whether written as an integer or not.
std::optional<uint64_t> wholeNumber(const json& value) {
  if (value.is_number_unsigned()) return value.get<uint64_t>();
  if (!value.is_number_float()) return std::nullopt;
  const double number = value.get<double>();
  if (!(number >= 0.0) || number > 0x1p53 || number != double(uint64_t(number))) return std::nullopt;
  return uint64_t(number);
}

}  // namespace

JsonObject::JsonObject(const json& value, std::string file, std::string place)
    : value_(&value), file_(std::move(file)), place_(std::move(place)) {
  if (!value.is_object()) fail("expected an object");
}

std::string JsonObject::placeOf(const std::string& key) const {
  return place_.empty() ? key : place_ + "." + key;
}

void JsonObject::fail(const std::string& what) const {
  throw Error(place_.empty() ? fmt::format("{}: {}", file_, what)
                             : fmt::format("{}: {}: {}", file_, place_, what));
}

void JsonObject::fail(const std::string& key, const std::string& what) const {
  throw Error(fmt::format("{}: {}: {}", file_, placeOf(key), what));
}

const json* JsonObject::find(const char* key) const {
  const auto found = value_->find(key);
  return found == value_->end() || found->is_null() ? nullptr : &*found;
}

std::vector<std::string> JsonObject::keys() const {
  std::vector<std::string> names;
  for (const auto& [key, value] : value_->items()) {
    if (!value.is_null()) names.push_back(key);
  }
  return names;
}

const json* JsonObject::list(const char* key) const {
  const json* value = find(key);
  if (value != nullptr && !value->is_array()) fail(key, "expected a list");
  return value;
}

std::optional<uint64_t> JsonObject::number(const char* key) const {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  const std::optional<uint64_t> result = wholeNumber(*value);
  if (!result) fail(key, "expected a whole number of at least 0");
  return result;
}

uint64_t JsonObject::requiredNumber(const char* key) const {
  if (!has(key)) fail(fmt::format("key \"{}\" is missing", key));
  return *number(key);
}

std::optional<size_t> JsonObject::index(const char* key, size_t size) const {
  const std::optional<uint64_t> result = number(key);
  if (result && *result >= size) {
    fail(key, fmt::format("{} is out of range, there are {} in the file", *result, size));
  }
  return result;
}

size_t JsonObject::requiredIndex(const char* key, size_t size) const {
  if (!has(key)) fail(fmt::format("key \"{}\" is missing", key));
  return *index(key, size);
}

bool JsonObject::isNumber(const char* key) const {
  const json* value = find(key);
  return value != nullptr && value->is_number();
}

std::optional<double> JsonObject::real(const char* key) const {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_number()) fail(key, "expected a number");
  return value->get<double>();
}

std::optional<std::string> JsonObject::text(const char* key) const {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_string()) fail(key, "expected a text");
  return value->get<std::string>();
}

bool JsonObject::boolean(const char* key, bool value_if_missing) const {
  const json* value = find(key);
  if (value == nullptr) return value_if_missing;
  if (!value->is_boolean()) fail(key, "expected true or false");
  return value->get<bool>();
}

std::optional<std::vector<double>> JsonObject::numbers(const char* key, size_t size) const {
  const json* value = list(key);
  if (value == nullptr) return std::nullopt;
  std::vector<double> result;
  for (const json& element : *value) {
    if (element.is_number()) result.push_back(element.get<double>());
  }
  if (value->size() != size || result.size() != size) fail(key, fmt::format("expected {} numbers", size));
  return result;
}

std::optional<std::vector<double>> JsonObject::numbers(const char* key) const {
  const json* value = list(key);
  return value == nullptr ? std::nullopt : numbers(key, value->size());
}

std::vector<size_t> JsonObject::indices(const char* key, size_t size) const {
  std::vector<size_t> result;
  const json* value = list(key);
  if (value == nullptr) return result;
  for (const json& element : *value) {
    const std::optional<uint64_t> number = wholeNumber(element);
    if (!number || *number >= size) {
      fail(fmt::format("{}[{}]", key, result.size()), fmt::format("expected an index below {}", size));
    }
    result.push_back(*number);
  }
  return result;
}

std::optional<JsonObject> JsonObject::object(const char* key) const {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  return JsonObject(*value, file_, placeOf(key));
}

JsonObject JsonObject::requiredObject(const char* key) const {
  if (!has(key)) fail(fmt::format("key \"{}\" is missing", key));
  return *object(key);
}

std::vector<JsonObject> JsonObject::objects(const char* key) const {
  std::vector<JsonObject> result;
  const json* value = list(key);
  if (value == nullptr) return result;
  result.reserve(value->size());
  for (const json& element : *value) {
    result.emplace_back(element, file_, fmt::format("{}[{}]", placeOf(key), result.size()));
  }
  return result;
}

std::vector<std::string> JsonObject::texts(const char* key) const {
  std::vector<std::string> result;
  const json* value = list(key);
  if (value == nullptr) return result;
  for (const json& element : *value) {
    if (!element.is_string()) fail(fmt::format("{}[{}]", key, result.size()), "expected a text");
    result.push_back(element.get<std::string>());
  }
  return result;
}

}  // namespace sightline

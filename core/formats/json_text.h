#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace sightline {

/// Parses JSON. A syntax error, a key that occurs twice in one object, a number beyond double and nesting
/// deeper than 200 levels are Errors that start with "FILE:LINE:COLUMN: " or "FILE: ".
nlohmann::json parseJson(std::string_view text, const std::string& file);

/// The same for JSON in which words such as NaN and -Infinity, as careless writers print them, stand in the
/// place of numbers: each is null. `words` is how many there were.
nlohmann::json parseJsonWithWords(std::string_view text, const std::string& file, uint64_t& words);

}  // namespace sightline

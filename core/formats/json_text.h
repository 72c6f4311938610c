#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace sightline {

/// Parses JSON. A syntax error, a key that occurs twice in one object, a number beyond double and nesting
/// deeper than 200 levels are Errors that start with "FILE:LINE:COLUMN: " or "FILE: ".
nlohmann::json parseJson(std::string_view text, const std::string& file);

}  // namespace sightline

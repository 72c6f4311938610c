#pragma once
#include <optional>
#include <string_view>

namespace sightline {

/// Reads a decimal number at the start of the text, correctly rounded whatever the locale, and cuts it and
/// the blanks before it off. Numbers beyond float become infinite or zero; "nan" and "inf" are read as such.
/// Nothing if there is no number, or something else than a blank or the end follows it.
std::optional<float> takeFloat(std::string_view& text);

}  // namespace sightline

#pragma once
#include <optional>
#include <string_view>

namespace sightline {

/// A number, correctly rounded to either precision.
struct Decimal {
  float single = 0.0f;
  double full = 0.0;
};

/// Reads a decimal number at the start of the text, whatever the locale, and cuts it and the blanks before it
/// off. Numbers beyond the precision become infinite or zero; "nan" and "inf" are read as such, and what
/// Microsoft's runtimes print for them ("1.#QNAN"). Nothing if
/// there is no number, or something else than a blank or the end follows it.
std::optional<Decimal> takeDecimal(std::string_view& text);

}  // namespace sightline

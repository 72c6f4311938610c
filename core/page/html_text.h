#pragma once
#include <string>
#include <string_view>

namespace sightline {

/// The text for HTML, between tags or in a quoted attribute: & < > " ' are escaped. What is not UTF-8, and
/// characters that HTML does not allow, become U+FFFD. Newlines and tabs stay.
std::string escapeHtml(std::string_view text);

}  // namespace sightline

#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sightline {

/// Decodes base64 (RFC 4648, section 4), padded or not. Nothing for any other character, a misplaced '=' or
/// an impossible length.
std::optional<std::vector<uint8_t>> decodeBase64(std::string_view text);

/// Encodes it, padded, without line breaks.
std::string encodeBase64(std::span<const uint8_t> bytes);

}  // namespace sightline

#pragma once
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace sightline {

/// "0x1.8p+1", to be read back without loss; "nan" and "inf" as such.
std::string hexFloat(float value);
/// The bits as 8 hexadecimal digits: "0x3f708000".
std::string bitsText(float value);
/// The components' bits with commas between them: what `sightline trace` takes.
std::string bitsText(const glm::vec3& v);

/// Reads all of the text: a decimal, correctly rounded; a hexadecimal float with an exponent, as hexFloat
/// writes it; or the bits of a float as 0x and 8 digits. Numbers beyond float become infinite or zero.
/// Nothing for anything else.
std::optional<float> readFloat(std::string_view text);
/// Three of them with commas between them.
std::optional<glm::vec3> readVector(std::string_view text);

}  // namespace sightline

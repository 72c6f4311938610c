#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sightline {

/// The alpha of an image: what a mask needs of it.
struct AlphaImage {
  uint32_t width = 0;
  uint32_t height = 0;
  /// Of each texel, row after row from the top, 65,535 being opaque; an alpha of 8 bits times 257. Empty: all
  /// are opaque.
  std::vector<uint16_t> alpha;
};

/// Reads a PNG, JPEG or WebP image, whichever its first bytes say. Of images whose format has no alpha (every
/// JPEG) only the header is read: nothing else matters. Throws Error that begins with `place` for any other
/// format, by name where it is known (KTX2, DDS, ...), and for damaged, cut off or too large images (more
/// than 2^28 texels, or 2^16 a side; of those with alpha, more than 2^24, and 256 for each byte of the file).
AlphaImage readAlphaImage(std::span<const uint8_t> bytes, const std::string& place);

}  // namespace sightline

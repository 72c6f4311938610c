#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace sightline {

/// One pixel, sRGB.
struct Rgb {
  uint8_t red = 0, green = 0, blue = 0;
  bool operator==(const Rgb&) const = default;
};

/// Rows from top to bottom, pixels.size() == width * height.
struct Image {
  uint32_t width = 0;
  uint32_t height = 0;
  std::vector<Rgb> pixels;

  Image() = default;
  Image(uint32_t columns, uint32_t rows, Rgb fill = {})
      : width(columns), height(rows), pixels(size_t(columns) * rows, fill) {}
  Rgb& at(uint32_t x, uint32_t y) { return pixels[size_t(y) * width + x]; }
  const Rgb& at(uint32_t x, uint32_t y) const { return pixels[size_t(y) * width + x]; }
};

/// The bytes of an 8-bit RGB PNG file. The image has at least one pixel. Throws Error (what failed).
std::vector<uint8_t> encodePng(const Image& image);

/// Writes an 8-bit RGB PNG, to a temporary name beside it and renamed. The image has at least one pixel.
/// Throws Error (file, what failed).
void savePng(const Image& image, const std::filesystem::path& file);

}  // namespace sightline

#include "core/formats/alpha_image.h"

#include <fmt/format.h>
#include <png.h>
#include <webp/decode.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "core/base/error.h"
#include "core/scene/surfaces.h"

namespace sightline {
namespace {

std::string_view textOf(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

[[noreturn]] void failOnImage(const std::string& place, const std::string& what) {
  throw Error(
      fmt::format("{}: {}; mend the texture, or take its masks as opaque: --opaque-masks", place, what));
}

void checkSize(uint64_t width, uint64_t height, const std::string& place) {
  if (width >= 1 && height >= 1 && width <= kMostTexelsASide && height <= kMostTexelsASide &&
      width * height <= kMostTexels) {
    return;
  }
  failOnImage(place, fmt::format("an image of {} x {} texels, expected 1 to {} a side and {} in all", width,
                                 height, kMostTexelsASide, kMostTexels));
}

/// A few bytes can claim any size, and decoding takes up to ten bytes a texel. An image of more than
/// kFreeTexels needs a byte for so many of them: every PNG of four bytes a texel has that, for deflate packs
/// a thousandfold at best.
constexpr uint64_t kTexelsAByte = 256;
constexpr uint64_t kFreeTexels = uint64_t(1) << 24;

/// Before any room is taken. bytes: of the image's file.
void checkBytes(const AlphaImage& image, size_t bytes, const std::string& place) {
  if (uint64_t(image.width) * image.height <= std::max(kFreeTexels, kTexelsAByte * bytes)) return;
  failOnImage(place, fmt::format("claims {} x {} texels in {} bytes, expected at most {} in each",
                                 image.width, image.height, bytes, kTexelsAByte));
}

/// Fourth bytes of texels of four.
std::vector<uint16_t> alphaOf(const std::vector<uint8_t>& rgba) {
  std::vector<uint16_t> alpha(rgba.size() / 4);
  for (size_t i = 0; i < alpha.size(); ++i) alpha[i] = uint16_t(rgba[4 * i + 3] * 257);
  return alpha;
}

/// libpng's reader of whole images; it reports errors without longjmp.
struct PngReader {
  png_image image{};
  PngReader() { image.version = PNG_IMAGE_VERSION; }
  ~PngReader() { png_image_free(&image); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
};

AlphaImage readPng(std::span<const uint8_t> bytes, const std::string& place) {
  PngReader reader;
  png_image& image = reader.image;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) {
    failOnImage(place, fmt::format("a PNG image that libpng does not read: {}", image.message));
  }
  checkSize(image.width, image.height, place);
  AlphaImage result{image.width, image.height, {}};
  if ((image.format & PNG_FORMAT_FLAG_ALPHA) == 0) return result;
  checkBytes(result, bytes.size(), place);
  const size_t texels = size_t(image.width) * image.height;
  const bool wide = (image.format & PNG_FORMAT_FLAG_LINEAR) != 0;  // 16 bits
  std::vector<uint8_t> narrow_rgba(wide ? 0 : texels * 4);
  std::vector<uint16_t> wide_rgba(wide ? texels * 4 : 0);
  image.format = wide ? PNG_FORMAT_LINEAR_RGB_ALPHA : PNG_FORMAT_RGBA;
  void* const target = wide ? static_cast<void*>(wide_rgba.data()) : narrow_rgba.data();
  if (png_image_finish_read(&image, nullptr, target, 0, nullptr) == 0) {
    failOnImage(place, fmt::format("a PNG image that is damaged or cut off: {}", image.message));
  }
  if (!wide) {
    result.alpha = alphaOf(narrow_rgba);
    return result;
  }
  result.alpha.resize(texels);
  for (size_t i = 0; i < texels; ++i) result.alpha[i] = wide_rgba[4 * i + 3];
  return result;
}

AlphaImage readWebp(std::span<const uint8_t> bytes, const std::string& place) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK) {
    failOnImage(place, "a WebP image that is damaged or cut off");
  }
  if (features.has_animation != 0) failOnImage(place, "a WebP animation, expected one image");
  checkSize(uint64_t(features.width), uint64_t(features.height), place);
  AlphaImage result{uint32_t(features.width), uint32_t(features.height), {}};
  if (features.has_alpha == 0) return result;
  checkBytes(result, bytes.size(), place);
  std::vector<uint8_t> rgba(size_t(result.width) * result.height * 4);
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), rgba.data(), rgba.size(), features.width * 4) ==
      nullptr) {
    failOnImage(place, "a WebP image that is damaged or cut off");
  }
  result.alpha = alphaOf(rgba);
  return result;
}

/// The size stands in the frame header (ITU T.81, B.2.2), a marker 0xffc0 .. 0xffcf but for three others.
AlphaImage readJpeg(std::span<const uint8_t> bytes, const std::string& place) {
  size_t at = 2;
  while (at + 9 <= bytes.size() && bytes[at] == 0xff) {
    const uint8_t marker = bytes[at + 1];
    if (marker == 0xff) {  // a fill byte
      ++at;
      continue;
    }
    const bool frame = marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame) {
      const uint32_t height = bytes[at + 5] * 256u + bytes[at + 6],
                     width = bytes[at + 7] * 256u + bytes[at + 8];
      checkSize(width, height, place);
      return {width, height, {}};
    }
    at += 2 + size_t(bytes[at + 2] * 256u + bytes[at + 3]);
  }
  failOnImage(place, "a JPEG image that is damaged or cut off");
}

}  // namespace

AlphaImage readAlphaImage(std::span<const uint8_t> bytes, const std::string& place) {
  using namespace std::string_view_literals;
  const std::string_view text = textOf(bytes);
  if (text.starts_with("\x89PNG\r\n\x1a\n"sv)) return readPng(bytes, place);
  if (text.starts_with("\xff\xd8\xff"sv)) return readJpeg(bytes, place);
  if (text.starts_with("RIFF"sv) && text.size() >= 12 && text.substr(8, 4) == "WEBP"sv) {
    return readWebp(bytes, place);
  }
  const std::pair<std::string_view, const char*> others[] = {{"\xabKTX 20\xbb\r\n\x1a\n"sv, "KTX2"},
                                                             {"\xabKTX 11\xbb\r\n\x1a\n"sv, "KTX"},
                                                             {"DDS "sv, "DDS"},
                                                             {"GIF8"sv, "GIF"},
                                                             {"BM"sv, "BMP"},
                                                             {"II*\0"sv, "TIFF"},
                                                             {"MM\0*"sv, "TIFF"},
                                                             {"sB"sv, "Basis"}};
  for (const auto& [magic, name] : others) {
    if (text.starts_with(magic)) {
      failOnImage(place, fmt::format("{} images are not read, only PNG, JPEG and WebP: convert it", name));
    }
  }
  failOnImage(place,
              text.empty() ? "the image is empty" : "no image that is read: it is no PNG, JPEG or WebP");
}

}  // namespace sightline

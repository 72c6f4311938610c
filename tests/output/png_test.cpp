#include "core/picture/png.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/base/error.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;

/// An empty folder that goes away with the test.
class PngTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "sightline-png-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  size_t filesIn() const { return size_t(std::distance(fs::directory_iterator(folder_), {})); }

  fs::path folder_;
};

std::string messageOf(const Image& image, const fs::path& file) {
  try {
    savePng(image, file);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

Image gradient(uint32_t width, uint32_t height) {
  Image image(width, height);
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) image.at(x, y) = {uint8_t(x), uint8_t(y), uint8_t(x * y)};
  }
  return image;
}

TEST_F(PngTest, ReadsBackEveryPixel) {
  const Image image = gradient(37, 11);
  const fs::path file = folder_ / "gradient.png";
  savePng(image, file);
  EXPECT_EQ(filesIn(), 1u);

  png_image read = {};
  read.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&read, file.c_str()), 0) << read.message;
  read.format = PNG_FORMAT_RGB;
  ASSERT_EQ(read.width, image.width);
  ASSERT_EQ(read.height, image.height);
  std::vector<Rgb> pixels(image.pixels.size());
  ASSERT_NE(png_image_finish_read(&read, nullptr, pixels.data(), 0, nullptr), 0) << read.message;
  for (size_t i = 0; i < pixels.size(); ++i) ASSERT_EQ(pixels[i], image.pixels[i]) << "pixel " << i;
}

TEST_F(PngTest, ReplacesAnOldFile) {
  const fs::path file = folder_ / "old.png";
  std::ofstream(file) << "old";
  savePng(gradient(2, 2), file);
  EXPECT_GT(fs::file_size(file), 3u);
  EXPECT_EQ(filesIn(), 1u);
}

TEST_F(PngTest, NamesTheFileThatItCannotCreate) {
  const fs::path file = folder_ / "no such folder" / "a.png";
  const std::string message = messageOf(gradient(2, 2), file);
  EXPECT_NE(message.find(file.string()), std::string::npos) << message;
}

TEST_F(PngTest, LeavesNothingBehindWhenItCannotRename) {
  const fs::path taken = folder_ / "taken.png";
  fs::create_directory(taken);
  const std::string message = messageOf(gradient(2, 2), taken);
  EXPECT_NE(message.find(taken.string()), std::string::npos) << message;
  EXPECT_EQ(filesIn(), 1u);
}

TEST_F(PngTest, RefusesAnImageWithoutPixels) {
  const fs::path file = folder_ / "empty.png";
  EXPECT_NE(messageOf(Image(), file).find("no pixels"), std::string::npos);
  Image torn = gradient(4, 4);
  torn.pixels.pop_back();
  EXPECT_NE(messageOf(torn, file).find("no pixels"), std::string::npos);
  EXPECT_EQ(filesIn(), 0u);
}

}  // namespace
}  // namespace sightline

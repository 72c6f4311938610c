// Every header of core/shared compiles on its own as C++, OpenCL C and GLSL.
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_TARGET_OPENCL_VERSION 120
#include <gtest/gtest.h>

#include <CL/opencl.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> sharedHeaders() {
  std::vector<fs::path> headers;
  for (const auto& entry : fs::directory_iterator(fs::path(SL_SOURCE_DIR) / "core/shared")) {
    if (entry.path().extension() == ".h") headers.push_back(entry.path().filename());
  }
  std::sort(headers.begin(), headers.end());
  return headers;
}

/// Exit status and everything that the command printed.
std::pair<int, std::string> runCommand(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::string text;
  char buffer[4096];
  while (size_t n = fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
  return {pclose(pipe), text};
}

class SharedHeader : public testing::TestWithParam<fs::path> {
 protected:
  /// A file in a scratch folder that includes the header after `before` and ends with `after`.
  fs::path source(const std::string& extension, const std::string& before, const std::string& after) {
    const fs::path file = folder_ / (GetParam().stem().string() + extension);
    std::ofstream(file) << before << "#include \"core/shared/" << GetParam().string() << "\"\n" << after;
    return file;
  }
  const sightline::TemporaryFolder folder_;
  const std::string include_ = std::string(" -I\"") + SL_SOURCE_DIR + "\" ";
};

TEST_P(SharedHeader, CompilesAsCpp) {
  const auto [status, text] =
      runCommand("g++ -std=c++20 -fsyntax-only -Wall -Wextra -Werror -ffp-contract=off" + include_ +
                 source(".alone.cpp", "", "int main() {}\n").string());
  EXPECT_EQ(status, 0) << text;
}

TEST_P(SharedHeader, CompilesAsOpenClC) {
  std::vector<cl::Platform> platforms;
  ASSERT_EQ(cl::Platform::get(&platforms), CL_SUCCESS) << "pocl-opencl-icd is needed";
  std::vector<cl::Device> devices;
  ASSERT_EQ(platforms.front().getDevices(CL_DEVICE_TYPE_ALL, &devices), CL_SUCCESS);
  const cl::Context context(devices.front());
  const std::string text = "#include \"core/shared/" + GetParam().string() +
                           "\"\n__kernel void nothing(__global float* x) { x[0] = 0; }\n";
  cl::Program program(context, text);
  fs::current_path(SL_SOURCE_DIR);  // build options cannot quote a folder whose name has blanks
  const int status = program.build(devices.front(), "-cl-std=CL1.2 -Werror -I.");
  EXPECT_EQ(status, CL_SUCCESS) << program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(devices.front());
}

TEST_P(SharedHeader, CompilesAsValidGlsl) {
  ASSERT_EQ(runCommand("glslangValidator --version").first, 0) << "glslang-tools is needed";
  const fs::path spirv = folder_ / "shader.spv";
  const std::string before =
      "#version 460\n#extension GL_GOOGLE_include_directive : require\n"
      "layout(local_size_x = 64) in;\n"
      "layout(std430, binding = 0) buffer Keys { uint sl_set_keys[]; };\n"
      "layout(std430, binding = 1) buffer Winner { uint sl_set_winner[]; };\n"
      "layout(std430, binding = 2) buffer Fresh { uint sl_set_fresh[]; };\n"
      "layout(std430, binding = 3) buffer Overflow { uint sl_set_overflow[]; };\n"
      "layout(push_constant) uniform Push { uint sl_set_capacity; };\n";
  const auto [status, text] =
      runCommand("glslangValidator -V --target-env vulkan1.2 -S comp" + include_ + "-o " + spirv.string() +
                 " " + source(".comp", before, "void main() {}\n").string());
  ASSERT_EQ(status, 0) << text;
  const auto [valid, message] = runCommand("spirv-val --target-env vulkan1.2 " + spirv.string());
  EXPECT_EQ(valid, 0) << message;
}

INSTANTIATE_TEST_SUITE_P(All, SharedHeader, testing::ValuesIn(sharedHeaders()),
                         [](const auto& header) { return header.param.stem().string(); });

}  // namespace

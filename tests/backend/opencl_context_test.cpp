// Choosing devices, and what is said when something does not fit.
#include "core/opencl/opencl_context.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/device/opencl/opencl_scene.h"
#include "core/opencl/opencl_devices.h"
#include "core/opencl/opencl_rounding.h"

namespace sightline {
namespace {

std::string errorOf(const std::string& selector) {
  try {
    OpenClContext context(selector);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

class OpenCl : public testing::Test {
 protected:
  void SetUp() override {
    devices_ = listOpenClDevices();
    if (devices_.empty()) GTEST_SKIP() << "no OpenCL device";
  }
  std::vector<DeviceInfo> devices_;
};

TEST_F(OpenCl, IsSelectedByIndexAndByPartOfItsName) {
  EXPECT_EQ(OpenClContext("opencl:0").info().name, devices_[0].name);
  EXPECT_EQ(devices_[0].id, "opencl:0");
  std::string part = devices_[0].name.substr(1, 8);
  for (char& c : part) c = char(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_EQ(OpenClContext("opencl:" + part).info().id, "opencl:0");
}

/// Every ability that the same results take, one line each.
TEST(OpenClFloats, EachMissingAbilityIsNamed) {
  const cl_device_fp_config good =
      CL_FP_DENORM | CL_FP_INF_NAN | CL_FP_ROUND_TO_NEAREST | CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT;
  const cl_device_fp_config good_double = CL_FP_DENORM | CL_FP_INF_NAN | CL_FP_ROUND_TO_NEAREST;
  EXPECT_EQ(whyFloatsDiffer(good, good_double), "");
  const auto expectReason = [&](cl_device_fp_config floats, cl_device_fp_config doubles, const char* part) {
    const std::string line = whyFloatsDiffer(floats, doubles);
    EXPECT_NE(line.find(part), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  };
  expectReason(good, 0, "double precision");
  expectReason(good & ~cl_device_fp_config(CL_FP_DENORM), good_double, "CL_FP_DENORM");
  expectReason(good & ~cl_device_fp_config(CL_FP_INF_NAN), good_double, "CL_FP_INF_NAN");
  expectReason(good & ~cl_device_fp_config(CL_FP_ROUND_TO_NEAREST), good_double, "CL_FP_ROUND_TO_NEAREST");
  expectReason(good & ~cl_device_fp_config(CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT), good_double,
               "CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT");
}

/// The self-test passes where the device promises correct rounding, and sees the usual shortcuts.
TEST_F(OpenCl, RoundingIsTried) {
  for (const OpenClDeviceChoice& device : findOpenClDevices()) {
    if (!device.info.unusable.empty()) continue;
    EXPECT_TRUE(roundsCorrectly(device.id)) << device.info.name;
    EXPECT_FALSE(roundsCorrectly(device.id, "a * (1.0f / b)")) << device.info.name;
    EXPECT_FALSE(roundsCorrectly(device.id, "a / b", "a * (1.0f / sqrt(a))")) << device.info.name;
    // Off by a unit in the last place where the quotient is next to the middle of two floats only.
    EXPECT_FALSE(roundsCorrectly(device.id, "(float)((double)a * (1 + 0x1p-30) / b)")) << device.info.name;
    EXPECT_FALSE(roundsCorrectly(device.id, "a / b", "(float)(sqrt((double)a) * (1 - 0x1p-30))"))
        << device.info.name;
    EXPECT_FALSE(roundsCorrectly(device.id, "fabs(a / b) < 0x1p-126f ? 0.0f : a / b")) << device.info.name;
  }
}

TEST_F(OpenCl, UnknownSelectorsAreToldWhatThereIs) {
  for (const char* selector : {"opencl:99", "opencl:no such name", "opencl:-1", "opencl:0x"}) {
    const std::string error = errorOf(selector);
    EXPECT_NE(error.find(selector), std::string::npos) << error;
    EXPECT_NE(error.find(devices_[0].name), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
  for (const char* selector : {"opencl:", "openclx", "cpu", ""}) {
    EXPECT_NE(errorOf(selector).find("expected opencl"), std::string::npos) << selector;
  }
}

TEST_F(OpenCl, TooLargeBuffersSayWhatWasNeededAndWhatThereIs) {
  OpenClContext context("opencl");
  try {
    context.buffer(context.maxAllocationBytes() + 1, "triangles of the scene");
    FAIL() << "expected an Error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("triangles of the scene take"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(context.allocatedBytes(), 0u);
}

TEST_F(OpenCl, CountsTheBytesOfItsBuffers) {
  OpenClContext context("opencl");
  {
    ClBuffer a = context.buffer(1000, "a"), b = context.buffer(64, "b");
    EXPECT_EQ(context.allocatedBytes(), 1064u);
    a = std::move(b);
  }
  EXPECT_EQ(context.allocatedBytes(), 0u);
}

TEST_F(OpenCl, AFailedBuildShowsItsLog) {
  OpenClContext context("opencl");
  try {
    context.build("kernel void spoilt() { nonsense; }", "-cl-std=CL1.2");
    FAIL() << "expected an Error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("nonsense"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("error:"), std::string::npos) << error.what();
  }
}

TEST_F(OpenCl, BuildsWithoutAWarning) {  // PoCL counts them on the user's terminal
  for (const uint32_t rays_per_item : {1u, 8u}) {
    OpenClContext context("opencl");
    EXPECT_NO_THROW(buildKernels(context, rays_per_item, {}, "-Werror")) << rays_per_item;
  }
}

TEST_F(OpenCl, RunsAnyProgram) {
  OpenClContext context("opencl");
  context.build(
      "kernel void fillSquares(global uint* out) {\n"
      "  out[get_global_id(0)] = SL_START + get_global_id(0) * get_global_id(0);\n"
      "}\n",
      "-cl-std=CL1.2 -Werror -DSL_START=5");
  const ClBuffer out = context.buffer(100 * 4, "squares");
  context.launch(context.kernel("fillSquares"), 100, 10, out);
  uint32_t squares[100] = {};
  context.read(out, squares, sizeof squares);
  for (uint32_t i = 0; i < 100; ++i) EXPECT_EQ(squares[i], 5 + i * i);
}

TEST_F(OpenCl, BytesComeBackAsWritten) {
  OpenClContext context("opencl");
  const ClBuffer buffer = context.buffer(16, "numbers");
  const uint32_t written[2] = {1, 2};
  context.fill(buffer, 7, 16);
  context.write(buffer, written, 8, 4);
  uint32_t read[4] = {};
  context.read(buffer, read, 16);
  EXPECT_EQ(read[0], 7u);
  EXPECT_EQ(read[1], 1u);
  EXPECT_EQ(read[2], 2u);
  EXPECT_EQ(read[3], 7u);
}

}  // namespace
}  // namespace sightline

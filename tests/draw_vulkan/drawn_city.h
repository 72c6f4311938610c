#pragma once
// A scene and a path through it, and the device that draws it.
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/base/error.h"
#include "core/draw/vulkan/depth_check.h"
#include "core/draw/vulkan/vulkan_query_backend.h"
#include "core/vulkan/vulkan_devices.h"
#include "tests/draw/draw_cases.h"
#include "tests/support/boxes.h"

namespace sightline::drawing_cases {

/// Whether some device can draw here; where SIGHTLINE_REQUIRE_VULKAN is set it must.
inline bool canDraw() {
  std::string reasons;
  try {
    for (const VulkanDeviceChoice& device : findVulkanDevices(drawingNeeds())) {
      if (device.info.unusable.empty()) return true;
      reasons += device.info.name + ": " + device.info.unusable + "; ";
    }
  } catch (const Error& error) {
    reasons = error.what();
  }
  if (std::getenv("SIGHTLINE_REQUIRE_VULKAN")) ADD_FAILURE() << "no Vulkan device can draw: " << reasons;
  return false;
}

using draw_cases::cameraAt;

/// A generated scene, drawn in parts of at most 128 triangles.
struct City {
  Scene scene;
  DrawScene parts;
  explicit City(uint64_t triangles = 6000, const char* name = "city")
      : City(generateScene(name, triangles, 1)) {}
  explicit City(Scene its) : scene(std::move(its)), parts(makeDrawScene(scene, {.split = 128})) {}

  /// Down a street, a turn, a cut to elsewhere, and up above all: another walk than draw_cases::cityWalk, on
  /// which a box that is a pixel too small hides something.
  std::vector<Camera> path(uint32_t frames, uint32_t width, uint32_t height) const {
    const AxisBox bounds = boundsOf(parts.drawables);
    const glm::dvec3 low(bounds.low), size = glm::dvec3(bounds.high) - low;
    std::vector<Camera> cameras;
    for (uint32_t f = 0; f < frames; ++f) {
      const double t = double(f) / frames;
      glm::dvec3 eye(low.x + size.x * (0.3 + 0.3 * t), 1.7, low.z + size.z * (0.1 + 0.7 * t));
      glm::dvec3 along(0.3, 0, 1);
      if (t > 0.3) along = {4 * (t - 0.3), 0.01, 1 - 3 * (t - 0.3)};
      if (t > 0.6) {
        eye = {low.x + size.x * 0.7, 2 + 60 * (t - 0.6), low.z + size.z * 0.4};
        along = {-1, -0.7 * (t - 0.6), 0.4};
      }
      cameras.push_back(cameraAt(parts, eye, eye + along, width, height));
    }
    return cameras;
  }
};

}  // namespace sightline::drawing_cases

#define SL_SKIP_WITHOUT_DRAWING() \
  if (!sightline::drawing_cases::canDraw()) GTEST_SKIP() << "no Vulkan device draws"

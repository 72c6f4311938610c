#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/base/nearest.h"
#include "core/device/device.h"
#include "core/device/registry/make_device.h"

namespace sightline {

/// Whether makeDevice may know the name: said before the scene is loaded. For commands that only trace rays.
inline CLI::Validator tracerName() {
  return CLI::Validator(
      [](std::string& name) {
        if (isDeviceName(name)) return std::string();
        const std::vector<std::string> kinds = {"cpu", "opencl", "vulkan", "embree"};
        return "no device \"" + name + "\"; sightline devices lists what can run here" +
               didYouMean(name, kinds);
      },
      "");
}

/// The same of a device that can bake.
inline CLI::Validator deviceName() {
  return CLI::Validator(
      [](std::string& name) {
        const std::string unknown = tracerName()(name);
        return unknown.empty() ? whyNoBakes(name) : unknown;
      },
      "");
}

}  // namespace sightline

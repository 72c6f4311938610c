#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/cli/nearest.h"
#include "core/device/device.h"

namespace sightline {

/// Whether makeDevice may know the name, of a device that can bake: said before the scene is loaded.
inline CLI::Validator deviceName() {
  return CLI::Validator(
      [](std::string& name) {
        if (name == "embree") {
          return std::string("embree traces rays for crosscheck and trace only; take cpu, opencl or vulkan");
        }
        if (isDeviceName(name)) return std::string();
        const std::vector<std::string> kinds = {"cpu", "opencl", "vulkan"};
        return "no device \"" + name + "\"; sightline devices lists what can run here" +
               didYouMean(name, kinds);
      },
      "");
}

}  // namespace sightline

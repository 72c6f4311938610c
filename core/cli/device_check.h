#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "core/device/device.h"

namespace sightline {

/// Whether makeDevice may know the name: said before the scene is loaded.
inline CLI::Validator deviceName() {
  return CLI::Validator(
      [](std::string& name) {
        if (isDeviceName(name)) return std::string();
        return "no device \"" + name + "\"; sightline devices lists what can run here";
      },
      "");
}

}  // namespace sightline

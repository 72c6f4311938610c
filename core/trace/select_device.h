#pragma once
// How "opencl:1" or "vulkan:nvidia" selects a device: the same for every kind of devices.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/trace/device_info.h"

namespace sightline {

/// What there is, for the end of an error message; `none` where there is nothing.
template <typename Found>
std::string inventory(const std::vector<Found>& devices, const char* none) {
  if (devices.empty()) return none;
  std::string text = "there is";
  for (const Found& device : devices) {
    text += fmt::format("{} {} ({}{}{})", &device == &devices.front() ? "" : ",", device.info.id,
                        device.info.name,
                        device.info.unusable.empty() ? "" : "; unusable: ", device.info.unusable);
  }
  return text;
}

/// The device for "KIND" (of the usable ones that of the lowest rank, the first of several), "KIND:INDEX" or
/// "KIND:PART-OF-NAME" (any case, the first that matches). Found has a DeviceInfo info. Throws Error that
/// lists what there is, or says `none` where there is nothing.
template <typename Found>
Found selectDevice(const std::string& selector, const std::string& kind, const std::vector<Found>& devices,
                   int (*rank)(const Found&), const char* none) {
  const auto lowerCase = [](std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
  };
  const bool named = selector.size() > kind.size() + 1 && selector[kind.size()] == ':';
  if (!selector.starts_with(kind) || (selector != kind && !named)) {
    throw Error(fmt::format("device \"{0}\": expected {1}, {1}:INDEX or {1}:PART-OF-NAME", selector, kind),
                kExitUsage);
  }
  const std::string wanted = named ? selector.substr(kind.size() + 1) : "";
  const Found* chosen = nullptr;
  size_t index = 0;
  const auto [end, failure] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (wanted.empty()) {
    for (const Found& device : devices) {
      if (device.info.unusable.empty() && (!chosen || rank(device) < rank(*chosen))) chosen = &device;
    }
  } else if (failure == std::errc() && end == wanted.data() + wanted.size()) {
    if (index < devices.size()) chosen = &devices[index];
  } else {
    const auto found = std::find_if(devices.begin(), devices.end(), [&](const Found& device) {
      return lowerCase(device.info.name).find(lowerCase(wanted)) != std::string::npos;
    });
    if (found != devices.end()) chosen = &*found;
  }
  if (!chosen) throw Error(fmt::format("device \"{}\": {}", selector, inventory(devices, none)));
  if (!chosen->info.unusable.empty()) {
    throw Error(fmt::format("device \"{}\" ({}) cannot be used: {}", selector, chosen->info.name,
                            chosen->info.unusable));
  }
  return *chosen;
}

}  // namespace sightline

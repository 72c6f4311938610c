#include <fmt/core.h>

#include "core/cli/commands.h"
#include "core/device/device.h"
#include "core/device/registry/make_device.h"

namespace sightline {
namespace {

std::string line(const DeviceInfo& device) {
  const std::string start = fmt::format("{:<10}  {}", device.id, device.name);
  if (!device.unusable.empty()) return fmt::format("{}: cannot run here: {}\n", start, device.unusable);
  const double gib = double(device.memory_bytes) / 0x1p30;
  return fmt::format("{} ({}{}; driver: {})\n", start,
                     device.memory_bytes == 0 ? "" : fmt::format("{:.1f} GiB, ", gib), device.layout,
                     device.driver);
}

void printDevices() {
  bool has_opencl = false;
  for (const DeviceInfo& device : listDevices()) {
    std::fputs(line(device).c_str(), stdout);
    has_opencl = has_opencl || device.id.starts_with("opencl");
  }
  if (!has_opencl) {
    std::fputs(
        "opencl      none found: install pocl-opencl-icd for the processor, or a GPU's OpenCL driver\n",
        stdout);
  }
}

}  // namespace

void addDevicesCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("devices", "List what can trace here, and why what cannot");
  command->callback(printDevices);
}

}  // namespace sightline

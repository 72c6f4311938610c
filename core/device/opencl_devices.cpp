#include "core/device/opencl_devices.h"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>

#include "core/error.h"

namespace sightline {
namespace {

std::string clDeviceText(cl_device_id device, cl_device_info property) {
  size_t size = 0;
  checkCl(clGetDeviceInfo(device, property, 0, nullptr, &size), "clGetDeviceInfo");
  std::string text(size, '\0');
  checkCl(clGetDeviceInfo(device, property, size, text.data(), nullptr), "clGetDeviceInfo");
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
  return text;
}

/// Why a device cannot run the program; empty: it can.
std::string whyUnusable(cl_device_id device) {
  if (!clDeviceValue<cl_bool>(device, CL_DEVICE_AVAILABLE)) return "the device is not available";
  if (!clDeviceValue<cl_bool>(device, CL_DEVICE_COMPILER_AVAILABLE)) return "its driver has no compiler";
  if (!clDeviceValue<cl_bool>(device, CL_DEVICE_ENDIAN_LITTLE)) return "it is big-endian";
  if (clDeviceValue<cl_device_fp_config>(device, CL_DEVICE_DOUBLE_FP_CONFIG) == 0) {
    return "it has no double precision, which close calls of the intersection test take";
  }
  const auto config = clDeviceValue<cl_device_fp_config>(device, CL_DEVICE_SINGLE_FP_CONFIG);
  if (!(config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT)) {
    return "it does not divide correctly rounded (CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT), so that its results "
           "would differ from other devices'";
  }
  if (!(config & CL_FP_ROUND_TO_NEAREST)) return "it does not round floats to nearest";
  return {};
}

OpenClDevice describeDevice(cl_device_id id, size_t index) {
  OpenClDevice device;
  device.id = id;
  device.info.id = fmt::format("opencl:{}", index);
  try {
    device.type = clDeviceValue<cl_device_type>(id, CL_DEVICE_TYPE);
    device.info.name = clDeviceText(id, CL_DEVICE_NAME);
    device.info.driver =
        clDeviceText(id, CL_DEVICE_VERSION) + ", driver " + clDeviceText(id, CL_DRIVER_VERSION);
    device.info.layout = device.type & CL_DEVICE_TYPE_CPU ? "bvh2, packets of 8 rays" : "bvh2, single rays";
    device.info.memory_bytes = clDeviceValue<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE);
    device.info.unusable = whyUnusable(id);
  } catch (const Error& error) {
    device.info.unusable = error.what();
  }
  return device;
}

/// Without HOME, PoCL would keep compiled kernels in /tmp, where others may write: sends it to the cache
/// folder of the user's entry in the password file, or tells it to keep nothing.
void keepCacheInUsersFolder() {
  if (std::getenv("POCL_CACHE_DIR") || std::getenv("XDG_CACHE_HOME") || std::getenv("HOME")) return;
  const passwd* user = getpwuid(getuid());
  if (user && user->pw_dir && user->pw_dir[0] == '/') {
    setenv("POCL_CACHE_DIR", (std::string(user->pw_dir) + "/.cache/pocl").c_str(), 0);
  } else {
    setenv("POCL_KERNEL_CACHE", "0", 0);
  }
}

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// What there is, for the end of an error message.
std::string inventory(const std::vector<OpenClDevice>& devices) {
  if (devices.empty()) {
    return "no OpenCL device found: install a driver (Debian: pocl-opencl-icd runs on any processor; it "
           "needs a "
           "cache folder that it can write: POCL_CACHE_DIR, else ~/.cache), or take --device cpu";
  }
  std::string text = "there is";
  for (const OpenClDevice& device : devices) {
    text += fmt::format("{} {} ({}{}{})", &device == &devices.front() ? "" : ",", device.info.id,
                        device.info.name,
                        device.info.unusable.empty() ? "" : "; unusable: ", device.info.unusable);
  }
  return text;
}

/// GPUs before CPUs before the rest.
int rank(const OpenClDevice& device) {
  return device.type & CL_DEVICE_TYPE_GPU ? 0 : (device.type & CL_DEVICE_TYPE_CPU ? 1 : 2);
}

const OpenClDevice* match(const std::vector<OpenClDevice>& devices, const std::string& wanted) {
  if (wanted.empty()) {
    const OpenClDevice* best = nullptr;
    for (const OpenClDevice& device : devices) {
      if (device.info.unusable.empty() && (!best || rank(device) < rank(*best))) best = &device;
    }
    return best;
  }
  size_t index = 0;
  const auto [end, failure] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (failure == std::errc() && end == wanted.data() + wanted.size()) {
    return index < devices.size() ? &devices[index] : nullptr;
  }
  const auto found = std::find_if(devices.begin(), devices.end(), [&](const OpenClDevice& device) {
    return lowerCase(device.info.name).find(lowerCase(wanted)) != std::string::npos;
  });
  return found == devices.end() ? nullptr : &*found;
}

}  // namespace

std::vector<OpenClDevice> findOpenClDevices() {
  keepCacheInUsersFolder();
  std::vector<OpenClDevice> devices;
  cl_uint platform_count = 0;
  // Without an installed driver the loader answers with an error; that is no failure of ours.
  if (clGetPlatformIDs(0, nullptr, &platform_count) != CL_SUCCESS) return devices;
  std::vector<cl_platform_id> platforms(platform_count);
  if (clGetPlatformIDs(platform_count, platforms.data(), nullptr) != CL_SUCCESS) return devices;
  for (cl_platform_id platform : platforms) {
    cl_uint count = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) continue;
    std::vector<cl_device_id> ids(count);
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, ids.data(), nullptr) != CL_SUCCESS) continue;
    for (cl_device_id id : ids) devices.push_back(describeDevice(id, devices.size()));
  }
  return devices;
}

OpenClDevice selectOpenClDevice(const std::string& selector) {
  const std::string prefix = "opencl";
  const bool named = selector.size() > prefix.size() + 1 && selector[prefix.size()] == ':';
  if (selector.compare(0, prefix.size(), prefix) != 0 || (selector != prefix && !named)) {
    throw Error(fmt::format("device \"{}\": expected opencl, opencl:INDEX or opencl:PART-OF-NAME", selector),
                kExitUsage);
  }
  const std::vector<OpenClDevice> devices = findOpenClDevices();
  const OpenClDevice* device = match(devices, named ? selector.substr(prefix.size() + 1) : "");
  if (!device) throw Error(fmt::format("device \"{}\": {}", selector, inventory(devices)));
  if (!device->info.unusable.empty()) {
    throw Error(fmt::format("device \"{}\" ({}) cannot be used: {}", selector, device->info.name,
                            device->info.unusable));
  }
  return *device;
}

void requireOpenClDevice(const std::string& selector) {
  selectOpenClDevice(selector);
}

std::vector<DeviceInfo> listOpenClDevices() {
  std::vector<DeviceInfo> list;
  for (OpenClDevice& device : findOpenClDevices()) list.push_back(std::move(device.info));
  return list;
}

}  // namespace sightline

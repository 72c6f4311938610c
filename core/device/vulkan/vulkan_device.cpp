#include "core/device/vulkan/vulkan_device.h"

#include <optional>

#include "core/base/error.h"
#include "core/device/gpu/gpu_sampler.h"
#include "core/device/vulkan/tracing_needs.h"
#include "core/device/vulkan/vulkan_raster.h"
#include "core/device/vulkan/vulkan_stages.h"
#include "core/shared/hemicube.h"

namespace sightline {
namespace {

/// The sampler, which draws hemicubes besides.
class VulkanDevice final : public GpuSampler<VulkanStages>, private HemicubeDrawer {
 public:
  using GpuSampler<VulkanStages>::GpuSampler;

  void beginCell(std::span<const Face> faces, const StageParams& params) override {
    hemicubes_.clear();
    GpuSampler::beginCell(faces, params);
  }

  HemicubeDrawer& drawer() override { return *this; }

  void rasterize(std::span<const ViewFrame> hemicube, uint32_t resolution, float near_distance) override {
    VulkanRunner& runner = api().runner();
    if (runner.launch.instance_count > 0) {
      throw Error("hemicubes are drawn of plain scenes: --flatten writes out this scene's instances");
    }
    if (!raster_ || raster_->resolution() != resolution) {
      runner.commands.finish();
      raster_.reset();
      raster_.emplace(api().context(), runner, resolution, triangleCount());
      pixels_ = VulkanStage::list(api().context(), "insert_pixels");
    }
    const uint32_t samples = hemicubeSamples(resolution);
    runner.launch.hemicube = put(hemicube_, hemicube, "views of a hemicube");
    runner.launch.raster_resolution = resolution;
    runner.launch.raster_first = static_cast<uint32_t>(hemicubes_.size() / kHemicubeViews * samples + 1);
    runner.launch.raster_near = near_distance;
    raster_->draw();
    traceUntilItFits([&] { runner.run(pixels_, samples); });
    hemicubes_.insert(hemicubes_.end(), hemicube.begin(), hemicube.end());
    bookPixels(samples);
  }

  uint32_t collect(uint32_t stage) override {
    api().runner().launch.hemicubes = hemicubes_.empty() ? 0 : put(batch_, hemicubes_, "hemicubes");
    hemicubes_.clear();
    return GpuSampler::collect(stage);
  }

 private:
  VkDeviceAddress put(VulkanBuffer& buffer, std::span<const ViewFrame> views, const char* what) {
    enlarge(buffer, views.size_bytes(), what);
    api().write(buffer, views.data(), views.size_bytes());
    return buffer.address();
  }

  VulkanBuffer hemicube_, batch_;
  std::optional<VulkanRaster> raster_;  ///< made when it is first needed
  VulkanStage pixels_;
  std::vector<ViewFrame> hemicubes_;  ///< of the batch, five views each
};

}  // namespace

std::unique_ptr<Device> makeVulkanDevice(const std::string& selector, const Scene& scene, const Bvh& bvh,
                                         const DeviceOptions& options) {
  return std::make_unique<VulkanDevice>(scene, options, selector, scene, bvh, options);
}

DeviceInfo requireVulkanDevice(const std::string& selector) {
  return selectVulkanDevice(selector, tracingNeeds(false)).info;
}

std::vector<DeviceInfo> listVulkanDevices() {
  std::vector<DeviceInfo> list;
  try {
    for (VulkanDeviceChoice& device : findVulkanDevices(tracingNeeds(false))) {
      device.info.layout = vulkanLayout(device.abilities.features.contains(VulkanFeature::kPipelines));
      list.push_back(std::move(device.info));
    }
  } catch (const Error& error) {
    DeviceInfo none;
    none.id = "vulkan";
    none.name = "none found";
    none.unusable = error.what();
    list.push_back(none);
  }
  return list;
}

}  // namespace sightline

#include "core/device/embree/embree_device.h"

#include "core/base/error.h"

#ifdef SL_HAVE_EMBREE
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/scene/instances.h"
#include "core/shared/ray.h"

namespace sightline {
namespace {

/// Rays of one task.
constexpr size_t kChunk = 4096;

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using EmbreeLibrary = std::unique_ptr<RTCDeviceTy, Release>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, Release>;
using EmbreeGeometry = std::unique_ptr<RTCGeometryTy, Release>;

/// A ray does not meet what it begins on: t > 0, where Embree takes t >= 0.
void rejectOrigin(const RTCFilterFunctionNArguments* arguments) {
  if (!(RTCRayN_tfar(arguments->ray, arguments->N, 0) > 0)) arguments->valid[0] = 0;
}

class EmbreeTracer final : public Tracer {
 public:
  /// Scenes with instances are written out.
  explicit EmbreeTracer(const Scene& scene)
      : library_(rtcNewDevice(nullptr)), scene_(rtcNewScene(library_.get())) {
    const EmbreeGeometry mesh(rtcNewGeometry(library_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    const Scene written = scene.hasInstances() ? flatten(scene) : Scene();
    const Scene& plain = scene.hasInstances() ? written : scene;
    copy(mesh.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, plain.positions);
    copy(mesh.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, plain.triangles);
    rtcSetGeometryIntersectFilterFunction(mesh.get(), rejectOrigin);
    rtcCommitGeometry(mesh.get());
    rtcAttachGeometry(scene_.get(), mesh.get());
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_.get());
    check("build its tree");
  }

  DeviceInfo info() const override { return embreeDeviceInfo(); }

  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override {
    tbb::parallel_for(size_t(0), (rays.size() + kChunk - 1) / kChunk, [&](size_t chunk) {
      for (size_t i = chunk * kChunk; i < std::min(rays.size(), (chunk + 1) * kChunk); ++i) {
        hits[i] = hasDirection(rays[i]) ? trace(rays[i]) : Hit{0, kNoTriangle};
      }
    });
    check("trace");
  }

  void traceViews(std::span<const ViewFrame> views, uint32_t resolution,
                  std::span<uint32_t> triangles) override {
    tbb::parallel_for(size_t(0), views.size() * resolution, [&](size_t row) {
      for (uint32_t x = 0; x < resolution; ++x) {
        const auto y = static_cast<uint32_t>(row % resolution);
        triangles[row * resolution + x] = trace(viewRay(views[row / resolution], x, y, resolution)).triangle;
      }
    });
    check("trace");
  }

 private:
  template <typename Element>
  void copy(RTCGeometry mesh, RTCBufferType type, RTCFormat format, const std::vector<Element>& from) {
    void* to = rtcSetNewGeometryBuffer(mesh, type, 0, format, sizeof(Element), from.size());
    if (to == nullptr) check("take the scene");
    std::memcpy(to, from.data(), from.size() * sizeof(Element));
  }

  Hit trace(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray.org_x = ray.origin.x;
    query.ray.org_y = ray.origin.y;
    query.ray.org_z = ray.origin.z;
    query.ray.dir_x = ray.direction.x;
    query.ray.dir_y = ray.direction.y;
    query.ray.dir_z = ray.direction.z;
    query.ray.tfar = HUGE_VALF;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {0, kNoTriangle};
    return {query.ray.tfar, query.hit.primID};
  }

  void check(const char* what) const {
    const RTCError error = rtcGetDeviceError(library_.get());
    if (error == RTC_ERROR_NONE) return;
    throw Error(fmt::format(
        "embree: cannot {}: {}", what,
        error == RTC_ERROR_OUT_OF_MEMORY ? "out of memory" : fmt::format("error {}", int(error))));
  }

  EmbreeLibrary library_;
  EmbreeScene scene_;
};

}  // namespace

DeviceInfo embreeDeviceInfo() {
  DeviceInfo info;
  info.id = "embree";
  info.name = "Embree, for crosscheck and trace only";
  info.driver = RTC_VERSION_STRING;
  info.layout = "its own bvh, robust";
  info.on_cpu = true;
  return info;
}

std::unique_ptr<Tracer> makeEmbreeTracer(const Scene& scene) {
  return std::make_unique<EmbreeTracer>(scene);
}

}  // namespace sightline

#else

namespace sightline {

DeviceInfo embreeDeviceInfo() {
  DeviceInfo info;
  info.id = "embree";
  info.name = "Embree, for crosscheck and trace only";
  info.unusable = "built without it; install libembree-dev (version 3) and build again";
  return info;
}

std::unique_ptr<Tracer> makeEmbreeTracer(const Scene&) {
  requireEmbree();
  return nullptr;
}

}  // namespace sightline

#endif

sightline::DeviceInfo sightline::requireEmbree() {
  DeviceInfo info = embreeDeviceInfo();
  if (!info.unusable.empty()) throw Error("device \"embree\" cannot be used: " + info.unusable);
  return info;
}

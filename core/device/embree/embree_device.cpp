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

/// What a ray's filter needs to know. Embree's own comes first: the filter gets a pointer to that.
struct FilterContext {
  RTCIntersectContext embree;
  const Surfaces* surfaces;
  std::vector<uint32_t>* glass;  ///< gets the glass that the ray meets; null: none is to be listed
};

/// Whether a mask holds at a place of its image, in double: independent of what our own tracers do.
bool holdsAt(const Surfaces& surfaces, const MaskedTriangle& t, double u, double v) {
  const uvec4 mask = surfaces.masks[t.corner_c_mask.z].size_wrap_first;
  const double scale = std::ldexp(1.0, -int(t.corner_c_mask.w)), offset = std::ldexp(1.0, 30) * scale;
  uint64_t texel[2];
  for (int axis = 0; axis < 2; ++axis) {
    const double a = t.corners_ab[axis] * scale - offset, b = t.corners_ab[axis + 2] * scale - offset,
                 c = t.corner_c_mask[axis] * scale - offset;
    const double place = std::floor((1.0 - u - v) * a + u * b + v * c), size = mask[axis];
    const uint32_t wrap = axis == 0 ? mask.z & 3u : mask.z >> 2;
    double inside = std::clamp(place, 0.0, size - 1.0);
    if (wrap == kWrapRepeat) inside = place - std::floor(place / size) * size;
    if (wrap == kWrapMirror) {
      inside = place - std::floor(place / (2.0 * size)) * 2.0 * size;
      inside = std::min(inside, 2.0 * size - 1.0 - inside);
    }
    texel[axis] = uint64_t(inside);
  }
  const uint64_t bit = texel[1] * mask.x + texel[0];
  return (surfaces.texels[mask.w + bit / 32] >> (bit % 32) & 1u) != 0;
}

/// A ray does not meet what it begins on: t > 0, where Embree takes t >= 0. Nor holes, nor backs of what has
/// only a front; and it goes on behind glass.
void filterHit(const RTCFilterFunctionNArguments* arguments) {
  const auto reject = [&] { arguments->valid[0] = 0; };
  if (!(RTCRayN_tfar(arguments->ray, arguments->N, 0) > 0)) return reject();
  const auto& context = *reinterpret_cast<const FilterContext*>(arguments->context);
  RTCHitN* const hit = arguments->hit;
  const uint32_t triangle = RTCHitN_primID(hit, 1, 0), surface = context.surfaces->of(triangle);
  if (surface == 0) return;
  const auto product = [](float a, float b) { return double(a) * double(b); };
  const double facing = product(RTCHitN_Ng_x(hit, 1, 0), RTCRayN_dir_x(arguments->ray, 1, 0)) +
                        product(RTCHitN_Ng_y(hit, 1, 0), RTCRayN_dir_y(arguments->ray, 1, 0)) +
                        product(RTCHitN_Ng_z(hit, 1, 0), RTCRayN_dir_z(arguments->ray, 1, 0));
  if ((surface & kSurfaceFrontOnly) != 0 && facing > 0) return reject();
  if ((surface & kSurfaceMasked) != 0 &&
      !holdsAt(*context.surfaces, context.surfaces->masked[surface & kSurfaceIndex], RTCHitN_u(hit, 1, 0),
               RTCHitN_v(hit, 1, 0))) {
    return reject();
  }
  if ((surface & kSurfaceGlass) == 0) return;
  if (context.glass != nullptr) context.glass->push_back(triangle);
  reject();
}

class EmbreeTracer final : public Tracer {
 public:
  /// Scenes with instances are written out.
  explicit EmbreeTracer(const Scene& scene)
      : library_(rtcNewDevice(nullptr)),
        scene_(rtcNewScene(library_.get())),
        has_glass_(featuresOf(scene.surfaces).glass) {
    const EmbreeGeometry mesh(rtcNewGeometry(library_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    const Scene written = scene.hasInstances() ? flatten(scene) : Scene();
    const Scene& plain = scene.hasInstances() ? written : scene;
    surfaces_ = plain.surfaces;
    copy(mesh.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, plain.positions);
    copy(mesh.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, plain.triangles);
    rtcSetGeometryIntersectFilterFunction(mesh.get(), filterHit);
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

  bool hasGlass() const override { return has_glass_; }

  std::vector<SeenThrough> traceGlass(std::span<const Ray> rays, std::span<const Hit> hits) override {
    std::vector<SeenThrough> seen;
    if (!has_glass_) return seen;
    for (size_t i = 0; i < rays.size(); ++i) {
      if (!hasDirection(rays[i])) continue;
      std::vector<uint32_t> glass;
      trace(rays[i], hits[i].triangle == kNoTriangle ? HUGE_VALF : hits[i].t, &glass);
      std::ranges::sort(glass);
      glass.erase(std::unique(glass.begin(), glass.end()), glass.end());
      for (const uint32_t triangle : glass) seen.push_back({uint32_t(i), triangle});
    }
    check("trace");
    return seen;
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

  Hit trace(const Ray& ray, float farthest = HUGE_VALF, std::vector<uint32_t>* glass = nullptr) const {
    FilterContext context{{}, &surfaces_, glass};
    rtcInitIntersectContext(&context.embree);
    RTCRayHit query{};
    query.ray.org_x = ray.origin.x;
    query.ray.org_y = ray.origin.y;
    query.ray.org_z = ray.origin.z;
    query.ray.dir_x = ray.direction.x;
    query.ray.dir_y = ray.direction.y;
    query.ray.dir_z = ray.direction.z;
    query.ray.tfar = farthest;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context.embree, &query);
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
  Surfaces surfaces_;
  bool has_glass_;
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

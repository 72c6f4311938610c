#include "core/api/session.h"

#include "core/api/session_parts.h"
#include "core/base/error.h"
#include "core/device/naive/naive_device.h"
#include "core/device/registry/make_device.h"
#include "core/scene/check_scene.h"
#include "core/scene/scene_tree.h"
#include "core/scene/seen_through.h"

namespace sightline {

namespace {

/// Checks the scene. Its hash, if that is not that of the session's own scene.
std::optional<uint64_t> hashAhead(const Scene& scene, const SessionOptions& options) {
  checkScene(scene);
  for (const NamedTriangles& object : options.see_through) {
    if (uint64_t(object.first) + object.count <= scene.triangleCount()) continue;
    throw Error("an object to see through is beyond the scene: " + object.name, kExitUsage);
  }
  if (options.see_through.empty()) return {};
  return hashScene(scene);
}

}  // namespace

SessionParts::SessionParts(Scene scene_to_own, SessionOptions options_to_keep)
    : hash(hashAhead(scene_to_own, options_to_keep)),
      scene(seenThrough(std::move(scene_to_own), options_to_keep.see_through)),
      options(std::move(options_to_keep)) {}

const Bvh& SessionParts::tree() {
  if (!bvh) {
    BvhConfig config;
    config.spatial_splits = options.spatial_splits;
    config.threads = options.device_options.threads;
    bvh = buildSceneTree(scene, config);
  }
  return *bvh;
}

Device& SessionParts::device(Method method, float hole) {
  const bool on_host = method == Method::kNaive || hole > 0;
  std::unique_ptr<Device>& wanted = on_host ? naive : plain;
  if (wanted && (!on_host || hole == smallest_hole)) return *wanted;
  wanted.reset();
  requireDevice(options.device);  // before the work that the tree takes
  wanted = makeDevice(options.device, scene, tree(), options.device_options);
  if (on_host) wanted = makeNaiveDevice(std::move(wanted), scene, smallest_hole = hole);
  return *wanted;
}

Tracer& SessionParts::tracer() {
  if (plain) return *plain;
  return naive ? *naive : device();
}

Session::Session(Scene scene, SessionOptions options)
    : parts_(std::make_unique<SessionParts>(std::move(scene), std::move(options))) {}
Session::~Session() = default;
Session::Session(Session&& other) noexcept = default;
Session& Session::operator=(Session&& other) noexcept = default;

const Scene& Session::scene() const {
  return parts_->scene;
}

const SessionOptions& Session::options() const {
  return parts_->options;
}

uint64_t Session::sceneHash() {
  if (!parts_->hash) parts_->hash = hashScene(parts_->scene);
  return *parts_->hash;
}

void Session::open() {
  parts_->tracer();
}

DeviceInfo Session::device() {
  return parts_->tracer().info();
}

void Session::traceRays(std::span<const Ray> rays, std::span<Hit> hits) {
  parts_->tracer().traceRays(rays, hits);
}

std::vector<SeenThrough> Session::traceGlass(std::span<const Ray> rays, std::span<const Hit> hits) {
  Tracer& tracer = parts_->tracer();
  return tracer.hasGlass() ? tracer.traceGlass(rays, hits) : std::vector<SeenThrough>();
}

}  // namespace sightline

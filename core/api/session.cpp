#include "core/api/session.h"

#include "core/api/session_parts.h"
#include "core/device/naive/naive_device.h"
#include "core/device/registry/make_device.h"
#include "core/scene/check_scene.h"
#include "core/scene/scene_tree.h"

namespace sightline {

SessionParts::SessionParts(Scene scene_to_own, SessionOptions options_to_keep)
    : scene(std::move(scene_to_own)), options(std::move(options_to_keep)) {
  checkScene(scene);
}

const Bvh& SessionParts::tree() {
  if (!bvh) {
    BvhConfig config;
    config.spatial_splits = options.spatial_splits;
    config.threads = options.device_options.threads;
    bvh = buildSceneTree(scene, config);
  }
  return *bvh;
}

Device& SessionParts::device(Method method) {
  std::unique_ptr<Device>& wanted = method == Method::kNaive ? naive : plain;
  if (wanted) return *wanted;
  requireDevice(options.device);  // before the work that the tree takes
  wanted = makeDevice(options.device, scene, tree(), options.device_options);
  if (method == Method::kNaive) wanted = makeNaiveDevice(std::move(wanted), scene);
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

}  // namespace sightline

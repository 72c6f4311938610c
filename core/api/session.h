#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/named_triangles.h"
#include "core/device/device_options.h"
#include "core/scene/scene.h"
#include "core/shared/types.h"
#include "core/trace/device_info.h"
#include "core/trace/seen_glass.h"

namespace sightline {

/// Where and how a session works. Nothing of it but the kind of intersection test (device "vulkan") changes
/// what is found, and see_through.
struct SessionOptions {
  std::string device = "cpu";         ///< a name as core/device/registry/device_names.h has them, of one that
                                      ///< bakes
  DeviceOptions device_options = {};  ///< threads are those of the tree, too
  bool spatial_splits = false;  ///< a tree that takes longer to build: faster rays where triangles are long
  std::vector<NamedTriangles> see_through =
      {};                       ///< objects that are seen but hide nothing, for all rays of the
                                ///< session (core/scene/find_objects.h). Ascending, disjoint.
  std::string scene_name = {};  ///< for people, kept in .pvs files: the scene's file without its folder
};

struct SessionParts;

/// A scene on a device, ready to trace and to bake: owns the scene, the tree over it and the device that
/// holds both. Move-only; a session that was moved from can only be assigned to or destroyed.
///
/// Tree and device are made at first use, or by open(): some seconds and 200 bytes a triangle for millions of
/// triangles. One thread at a time may use a session; sessions of different threads may work at the same
/// time.
///
///   Session session(loadScene("city.glb"), {.device = "opencl"});
///   const PvsFile pvs = bake(session, loadCells("cells.json"));   // core/api/bake.h
///   const auto visible = visibleFrom(pvs, {0, 1.6, 0});           // core/pvs/visible_from.h
class Session {
 public:
  /// Takes the scene, of a file (loadScene) or made by hand: positions and triangles suffice. Throws Error if
  /// it breaks an invariant of Scene. The device is not looked at yet.
  explicit Session(Scene scene, SessionOptions options = {});
  ~Session();
  Session(Session&& other) noexcept;
  Session& operator=(Session&& other) noexcept;

  const Scene& scene() const;
  const SessionOptions& options() const;
  /// hashScene of the scene: what a .pvs file of it must name. Takes a moment the first time.
  uint64_t sceneHash();

  /// Builds the tree and uploads both to the device, unless that is done. Throws Error that lists the devices
  /// if the name selects none that can run here, or if its memory does not suffice.
  void open();
  /// What the device is. Opens the session.
  DeviceInfo device();

  /// Nearest hits of rays: hits.size() == rays.size(), kNoTriangle where a ray meets nothing. Opens the
  /// session. Throws Error.
  void traceRays(std::span<const Ray> rays, std::span<Hit> hits);

  /// The glass that each ray meets no farther away than its hit (hits: as traceRays gave them): ascending by
  /// ray and triangle, each once. Nothing where the scene has none. Opens the session. Throws Error.
  std::vector<SeenThrough> traceGlass(std::span<const Ray> rays, std::span<const Hit> hits);

  /// What it is made of, for the library itself.
  SessionParts& parts() { return *parts_; }

 private:
  std::unique_ptr<SessionParts> parts_;
};

}  // namespace sightline

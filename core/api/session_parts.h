#pragma once
#include <memory>
#include <optional>

#include "bvh/bvh.h"
#include "core/api/session.h"
#include "core/device/device.h"
#include "core/pvs/method.h"

namespace sightline {

/// What a Session owns. Not copied and not moved: the devices refer to scene and tree.
struct SessionParts {
  SessionParts(Scene scene_to_own, SessionOptions options_to_keep);
  SessionParts(const SessionParts&) = delete;
  SessionParts& operator=(const SessionParts&) = delete;

  /// Builds it at the first call.
  const Bvh& tree();
  /// The device that bakes by this method; opens it at the first call. The naive method has one of its own,
  /// and so has a smallest hole.
  Device& device(Method method = Method::kGvspp, float smallest_hole = 0);
  /// A device that is open already, else device(): for rays that any may trace.
  Tracer& tracer();
  bool isOpen() const { return plain != nullptr || naive != nullptr; }

  std::optional<uint64_t> hash;  ///< of the scene as it was given, once it was asked for
  const Scene scene;
  const SessionOptions options;
  std::optional<Bvh> bvh;
  std::unique_ptr<Device> plain, naive;
  float smallest_hole = 0;  ///< of `naive`
};

}  // namespace sightline

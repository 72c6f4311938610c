#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/draw/draw_scene.h"
#include "core/draw/pvs_units.h"
#include "core/trace/device_info.h"
#include "core/walk/walk_frame.h"
#include "core/walk/walk_methods.h"

namespace sightline {

/// Milliseconds from whenever.
using WalkClock = std::function<double()>;

/// All that a walk draws. Must outlive devices and players.
struct WalkScene {
  const Scene& scene;
  const DrawScene& draw;
  const PvsUnits* units = nullptr;  ///< of a set, where there is one
};

/// Draws frames by one method, on the device that made it. Players of a device take turns: whoever draws a
/// frame also checks it before another one draws.
class WalkPlayer {
 public:
  virtual ~WalkPlayer() = default;

  /// Draws a frame, and waits until no more than in_flight - 1 of its own are still under way. number: as of
  /// CullMethod::drawFrame. times: gets what is known of this frame; FrameTimes::frame stays 0.
  virtual void draw(const Camera& camera, uint64_t number, uint32_t in_flight, FrameTimes& times) = 0;

  /// GPU times of frame `number` of this player, one of the last few drawn; waits until it has run.
  virtual void gpuTimes(uint64_t number, FrameTimes& times) = 0;

  /// Likewise what happened when.
  virtual WalkFrameSpans spans(uint64_t) { return {}; }

  /// What the last frame did; may wait until it has run.
  virtual FrameCounts counts() = 0;

  /// Drawables that the last frame drew. Waits until it has run.
  virtual std::vector<uint32_t> drawn() = 0;

  /// The last frame against one that draws everything.
  virtual FrameCheck check() = 0;
  /// Of the last check, row after row from the top: the pixels that are false, and the drawable that each
  /// should show (kNoTriangle: none).
  virtual std::vector<size_t> falsePixels() = 0;
  virtual std::vector<uint32_t> referenceDrawables() = 0;
  /// Likewise how deep each pixel should be: reversed, 0 where it shows nothing.
  virtual std::vector<float> referenceDepth() = 0;

  /// As if just made.
  virtual void forget() = 0;
};

/// What draws a walk.
class WalkDevice {
 public:
  virtual ~WalkDevice() = default;

  virtual DeviceInfo info() const = 0;
  /// Whether GPU times are known.
  virtual bool timesGpu() const = 0;
  /// Why the device cannot run a method, in one line; empty: it can.
  virtual std::string whyNot(const std::string& method) const = 0;
  /// A player of a method, by a name of walkMethods(), that whyNot says nothing against. Throws Error.
  virtual std::unique_ptr<WalkPlayer> play(const std::string& method, const WalkMethodOptions& options) = 0;
};

struct WalkDeviceOptions {
  bool semaphores = false;  ///< Vulkan: submits wait for each other by semaphores besides barriers
};

/// Throws Error, as makeWalkDevice does, for a name of no device that draws: before there is a scene.
void requireWalkDevice(const std::string& name);

/// "cpu": draws on the processor, slowly, the same everywhere. "vulkan", "vulkan:INDEX",
/// "vulkan:PART-OF-NAME": a device that draws. Throws Error that names what there is, or what the device
/// lacks.
std::unique_ptr<WalkDevice> makeWalkDevice(const std::string& name, const WalkScene& scene, WalkClock clock,
                                           const WalkDeviceOptions& options = {});

}  // namespace sightline

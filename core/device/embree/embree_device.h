#pragma once
#include <memory>

#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace sightline {

/// Embree 3, the tracer of others, as a peer to compare with; unusable where the program was built without
/// it.
DeviceInfo embreeDeviceInfo();

/// The same. Throws Error where it is unusable.
DeviceInfo requireEmbree();

/// Traces by Embree in its robust mode, single rays, on all threads. Which of equally near triangles it names
/// is its own choice. Throws Error.
std::unique_ptr<Tracer> makeEmbreeTracer(const Scene& scene);

}  // namespace sightline

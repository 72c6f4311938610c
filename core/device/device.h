#pragma once
#include "core/device/cell_sampler.h"
#include "core/device/device_options.h"
#include "core/device/hemicube_drawer.h"
#include "core/trace/tracer.h"

namespace sightline {

/// What bakes: traces any rays, samples view cells, and on some devices draws hemicubes. All parts share the
/// scene; take the narrowest that does.
class Device : public Tracer, public CellSampler {
 public:
  /// What draws into the sampler's batches. Throws Error (wrong usage) where the device has no such part.
  virtual HemicubeDrawer& drawer();
};

}  // namespace sightline

#pragma once
#include <cstdint>
#include <span>

#include "core/shared/view_ray.h"

namespace sightline {

/// Draws hemicubes into the batch of a CellSampler (core/device/cell_sampler.h): what bakes by the method
/// raster need besides.
class HemicubeDrawer {
 public:
  virtual ~HemicubeDrawer() = default;

  /// Draws a hemicube (hemicubeAt, core/sampling/hemicube.h) of resolution * resolution pixels an image, and
  /// inserts the triangle that each of its hemicubeSamples shows under that sample's index: a batch's
  /// hemicubes have consecutive indices, and one resolution. Counts samples as rays. near_distance:
  /// hemicubeNear. A batch is either traced or rasterised. Throws Error, also where the device cannot draw.
  virtual void rasterize(std::span<const ViewFrame> hemicube, uint32_t resolution, float near_distance) = 0;
};

}  // namespace sightline

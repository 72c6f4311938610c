#pragma once
#include <memory>

#include "core/device/device.h"
#include "core/scene/scene.h"

namespace sightline {

/// The naive implementation of gvs++ with which the thesis compares its own (5.5: more than 20 times slower):
/// every hit travels to the host, duplicates included, and set and queue live there. Rays are made by all of
/// the host's threads and traced by `inner`, batch by batch; one thread inserts. Gives the set of `inner`,
/// with the same witnesses, by gvs too: what `inner` itself must find of its own hits. scene: on `inner`,
/// outlives the device.
///
/// smallest_hole: above 0, a ray that is pinched by gaps narrower than that (core/trace/narrow_gap.h) finds
/// nothing, and as far as other rays follow from it, it ends at the gap. traceRays and traceViews stay as
/// they are.
std::unique_ptr<Device> makeNaiveDevice(std::unique_ptr<Device> inner, const Scene& scene,
                                        float smallest_hole = 0);

}  // namespace sightline

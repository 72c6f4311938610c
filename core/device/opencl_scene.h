#pragma once
#include <string>

#include "bvh/bvh.h"
#include "core/device/opencl_context.h"
#include "core/scene/scene.h"

namespace sightline {

/// A scene and its tree on an OpenCL device, in the layout that suits its kind: the 2-wide tree for packets
/// of eight rays on CPUs, for single rays elsewhere. Kernels with SL_SCENE_ARGS take the three values in
/// order:
///   context.launch(kernel, items, local, scene.nodes, scene.triangles, scene.reach, ...)
struct OpenClScene {
  ClBuffer nodes;
  ClBuffer triangles;
  float reach = 0;  ///< sceneReach of the bounds
};

/// Rays that a work item traces on the device: SL_PACKET of the program.
uint32_t raysPerItem(const OpenClContext& context);

/// Build options that the trace kernels need: pass to OpenClContext::build, with others.
std::string traceOptions(const OpenClContext& context);

/// Uploads in pieces, so that the host needs little memory besides scene and tree. Throws Error, also when
/// the tree is too deep or the device's memory too small.
OpenClScene uploadScene(OpenClContext& context, const Scene& scene, const Bvh& bvh);

/// For tests: the same with 2^24 + 1, say, added to all ids.
OpenClScene uploadScene(OpenClContext& context, const Scene& scene, const Bvh& bvh, uint32_t id_offset);

}  // namespace sightline

#pragma once
#include <string>

#include "bvh/bvh.h"
#include "core/opencl/opencl_context.h"
#include "core/scene/scene.h"

namespace sightline {

/// A scene and its tree on an OpenCL device: the 2-wide tree, and triangles as packets of eight rays or as
/// single rays read them fastest. Kernels with SL_SCENE_ARGS take the three values in order:
///   context.launch(kernel, items, local, scene.nodes, scene.triangles, scene.reach, ...)
struct OpenClScene {
  ClBuffer nodes;
  ClBuffer triangles;
  float reach = 0;  ///< sceneReach of the bounds
};

/// Rays that a work item traces where the device is fastest: packets of 8 on CPUs, 1 elsewhere.
uint32_t raysPerItem(const OpenClContext& context);

/// The compiler's options for our kernels, which trace so many rays a work item, 8 or 1.
std::string kernelOptions(uint32_t rays_per_item);

/// Builds our kernels (cl_kernels/program.cl) to trace so many rays a work item, 8 or 1. extra: further
/// options of the compiler. Throws Error.
void buildKernels(OpenClContext& context, uint32_t rays_per_item, const std::string& extra = {});

/// Uploads in pieces, so that the host needs little memory besides scene and tree. rays_per_item: as of
/// buildKernels. id_offset is for tests: 2^24 + 1, say, added to all ids. Throws Error, also when the tree is
/// too deep or the device's memory too small.
OpenClScene uploadScene(OpenClContext& context, const Scene& scene, const Bvh& bvh, uint32_t rays_per_item,
                        uint32_t id_offset = 0);

}  // namespace sightline

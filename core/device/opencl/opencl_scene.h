#pragma once
#include <string>

#include "bvh/bvh.h"
#include "core/opencl/opencl_context.h"
#include "core/scene/scene.h"

namespace sightline {

/// A scene and its tree on an OpenCL device: the 2-wide tree, and triangles as packets of eight rays or as
/// single rays read them fastest.
struct OpenClScene {
  ClBuffer nodes;
  ClBuffer triangles;
  float reach = 0;  ///< sceneReach of the bounds
  // Of a tree of two levels; else empty.
  ClBuffer instances, instance_order;
  uint32_t instance_count = 0;  ///< without what is in no mesh
  uint32_t root = 0;            ///< of the upper level

  /// Enqueues a kernel that takes SL_SCENE_ARGS and then args; as OpenClContext::launch.
  template <typename... Args>
  void launch(OpenClContext& context, const ClKernel& kernel, uint64_t global, uint32_t local,
              const Args&... args) const {
    if (instance_count == 0) return context.launch(kernel, global, local, nodes, triangles, reach, args...);
    context.launch(kernel, global, local, nodes, triangles, reach, instances, instance_order, instance_count,
                   root, args...);
  }
};

/// Rays that a work item traces where the device is fastest: packets of 8 on CPUs, 1 elsewhere.
uint32_t raysPerItem(const OpenClContext& context);

/// The compiler's options for our kernels, which trace so many rays a work item, 8 or 1.
std::string kernelOptions(uint32_t rays_per_item);

/// The further options that kernels need to trace a tree of two levels; none for others.
std::string kernelOptionsFor(const Bvh& bvh);

/// Builds our kernels (cl_kernels/program.cl) to trace so many rays a work item, 8 or 1. extra: further
/// options of the compiler (kernelOptionsFor). Throws Error.
void buildKernels(OpenClContext& context, uint32_t rays_per_item, const std::string& extra = {});

/// Uploads in pieces, so that the host needs little memory besides scene and tree. rays_per_item: as of
/// buildKernels. id_offset is for tests: 2^24 + 1, say, added to all ids. Throws Error, also when the tree is
/// too deep or the device's memory too small.
OpenClScene uploadScene(OpenClContext& context, const Scene& scene, const Bvh& bvh, uint32_t rays_per_item,
                        uint32_t id_offset = 0);

}  // namespace sightline

#pragma once
#include <string>

#include "bvh/bvh.h"
#include "core/opencl/opencl_context.h"
#include "core/scene/scene.h"

namespace sightline {

/// A scene and its tree on an OpenCL device: the 2-wide tree, and triangles as packets of eight rays or as
/// single rays read them fastest. Kernels with SL_SCENE_ARGS take the values in order, surfaces and instances
/// only where there are any: launchOnScene.
struct OpenClScene {
  ClBuffer nodes;
  ClBuffer triangles;
  ClBuffer surfaces;  ///< packSurfaces; without memory where all triangles are opaque from both sides
  float reach = 0;    ///< sceneReach of the bounds
  // Of a tree of two levels; else empty.
  ClBuffer instances, instance_order;
  uint32_t instance_count = 0;  ///< without what is in no mesh
  uint32_t root = 0;            ///< of the upper level
};

/// Rays that a work item traces where the device is fastest: packets of 8 on CPUs, 1 elsewhere.
uint32_t raysPerItem(const OpenClContext& context);

/// The further options that kernels need to trace a tree of two levels; none for others.
std::string kernelOptionsFor(const Bvh& bvh);

/// Builds our kernels (cl_kernels/program.cl) to trace so many rays a work item, 8 or 1, in scenes with
/// these surfaces. extra: further options of the compiler (kernelOptionsFor). Throws Error.
void buildKernels(OpenClContext& context, uint32_t rays_per_item, const SurfaceFeatures& features = {},
                  const std::string& extra = {});

/// Uploads in pieces, so that the host needs little memory besides scene and tree. rays_per_item: as of
/// buildKernels. id_offset is for tests: 2^24 + 1, say, added to all ids. Throws Error, also when the tree is
/// too deep or the device's memory too small.
OpenClScene uploadScene(OpenClContext& context, const Scene& scene, const Bvh& bvh, uint32_t rays_per_item,
                        uint32_t id_offset = 0);

/// Runs a kernel with SL_SCENE_ARGS and further arguments, built for the features of the scene's surfaces.
template <typename... Arguments>
void launchOnScene(OpenClContext& context, const ClKernel& kernel, uint64_t items, uint32_t local,
                   const OpenClScene& scene, const Arguments&... arguments) {
  const auto launch = [&](const auto&... its) {
    context.launch(kernel, items, local, scene.nodes, scene.triangles, scene.reach, its..., arguments...);
  };
  const bool surfaces = scene.surfaces.get() != nullptr;
  if (scene.instance_count > 0) {
    const auto on_instances = [&](const auto&... its) {
      launch(its..., scene.instances, scene.instance_order, scene.instance_count, scene.root);
    };
    surfaces ? on_instances(scene.surfaces) : on_instances();
  } else {
    surfaces ? launch(scene.surfaces) : launch();
  }
}

}  // namespace sightline

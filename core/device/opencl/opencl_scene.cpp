#include "core/device/opencl/opencl_scene.h"

#include <algorithm>

#include "cl_kernels/program_source.h"
#include "core/shared/box.h"
#include "core/trace/trace_layout.h"

namespace sightline {
namespace {

/// Records packed and uploaded at a time.
constexpr size_t kPieceRecords = 1 << 18;

void addToId(TriangleRecord& record, uint32_t offset) {
  record.id += offset;
}

void addToId(TriangleRecordGpu& record, uint32_t offset) {
  record.v0.w = uintBitsToFloat(floatBitsToUint(record.v0.w) + offset);
}

template <typename Record>
ClBuffer uploadTriangles(OpenClContext& context, const Scene& scene, const Bvh& bvh, uint32_t id_offset) {
  const size_t count = bvh.references.size();
  ClBuffer buffer = context.buffer(count * sizeof(Record), "triangles of the scene");
  std::vector<Record> piece(std::min(count, kPieceRecords));
  for (size_t first = 0; first < count; first += piece.size()) {
    const std::span<Record> records(piece.data(), std::min(piece.size(), count - first));
    packTriangles(scene, bvh, first, records);
    if (id_offset != 0) {
      for (Record& record : records) addToId(record, id_offset);
    }
    context.write(buffer, records.data(), records.size_bytes(), first * sizeof(Record));
  }
  return buffer;
}

/// The compiler's options for our kernels.
std::string kernelOptions(uint32_t rays_per_item, const SurfaceFeatures& features) {
  return kClBuildOptions + (" -DSL_PACKET=" + std::to_string(rays_per_item)) +
         (features.any() ? " -DSL_HAS_SURFACES=1" : "") + (features.glass ? " -DSL_HAS_GLASS=1" : "");
}

}  // namespace

uint32_t raysPerItem(const OpenClContext& context) {
  return context.isCpu() ? 8 : 1;
}

std::string kernelOptionsFor(const Bvh& bvh) {
  return bvh.hasInstances() ? "-DSL_INSTANCES=1" : "";
}

void buildKernels(OpenClContext& context, uint32_t rays_per_item, const SurfaceFeatures& features,
                  const std::string& extra) {
  context.build(kProgramSource, kernelOptions(rays_per_item, features) + " " + extra);
}

OpenClScene uploadScene(OpenClContext& context, const Scene& scene, const Bvh& bvh, uint32_t rays_per_item,
                        uint32_t id_offset) {
  checkTraceable(bvh);
  const bool packets = rays_per_item > 1;
  if (!packets) checkSingleRays(bvh.references.size());
  OpenClScene result;
  result.reach = sceneReach(bvh.low, bvh.high);
  const uint64_t node_bytes = bvh.nodes2.size() * sizeof(BvhNode2);
  result.nodes = context.buffer(node_bytes, "nodes of the tree");
  context.write(result.nodes, bvh.nodes2.data(), node_bytes);
  result.triangles = packets ? uploadTriangles<TriangleRecord>(context, scene, bvh, id_offset)
                             : uploadTriangles<TriangleRecordGpu>(context, scene, bvh, id_offset);
  if (featuresOf(scene.surfaces).any()) {
    const std::vector<uint32_t> surfaces = packSurfaces(scene.surfaces, bvh.references);
    result.surfaces = context.buffer(surfaces.size() * 4, "surfaces of the scene");
    context.write(result.surfaces, surfaces.data(), surfaces.size() * 4);
  }
  if (!bvh.hasInstances()) return result;
  const auto upload = [&](const auto& values, const char* what) {
    const uint64_t bytes = values.size() * sizeof values.front();
    ClBuffer buffer = context.buffer(bytes, what);
    context.write(buffer, values.data(), bytes);
    return buffer;
  };
  result.instances = upload(bvh.instances, "instances");
  result.instance_order = upload(bvh.instance_order, "order of the instances");
  result.instance_count = static_cast<uint32_t>(scene.instances.size());
  result.root = bvh.top2;
  return result;
}

}  // namespace sightline

#include "core/trace/trace_layout.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/base/error.h"

namespace sightline {

uint32_t recordId(const Scene& scene, const Bvh& bvh, uint32_t reference) {
  if (!scene.hasInstances()) return reference;
  if (reference < scene.plainTriangles()) return bvh.plainId(reference);
  const auto after =
      std::upper_bound(scene.meshes.begin(), scene.meshes.end(), reference,
                       [](uint32_t value, const SceneMesh& mesh) { return value < mesh.first_triangle; });
  return reference - (after - 1)->first_triangle;
}

namespace {

void pack(const std::array<glm::vec3, 3>& vertices, uint32_t id, TriangleRecord& record) {
  for (int i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis) record.vertices[3 * i + axis] = vertices[i][axis];
  }
  record.id = id;
}

void pack(const std::array<glm::vec3, 3>& vertices, uint32_t id, TriangleRecordGpu& record) {
  record.v0 = vec4(vertices[0], uintBitsToFloat(id));
  record.v1 = vec4(vertices[1], 0.0f);
  record.v2 = vec4(vertices[2], 0.0f);
}

template <typename Record>
void packAll(const Scene& scene, const Bvh& bvh, size_t first, std::span<Record> out) {
  tbb::parallel_for(size_t{0}, out.size(), [&](size_t i) {
    const uint32_t reference = bvh.references[first + i];
    pack(scene.cornersOf({reference, kNoTriangle}), recordId(scene, bvh, reference), out[i]);
  });
}

}  // namespace

void packTriangles(const Scene& scene, const Bvh& bvh, size_t first, std::span<TriangleRecord> out) {
  packAll(scene, bvh, first, out);
}

void packTriangles(const Scene& scene, const Bvh& bvh, size_t first, std::span<TriangleRecordGpu> out) {
  packAll(scene, bvh, first, out);
}

void checkSingleRays(uint64_t references) {
  if (references <= kMostGpuReferences) return;
  throw Error(fmt::format(
      "{} triangles in the leaves of the tree, this OpenCL device takes {} at most: split the scene, or take "
      "--device cpu",
      references, kMostGpuReferences));
}

void checkTraceable(const Bvh& bvh) {
  if (bvh.nodes2.empty() || bvh.nodes8.empty()) {
    throw Error("the tree has no nodes: build it with buildBvh from at least one triangle");
  }
  if (bvh.depth > kMaxDepth) {
    throw Error(fmt::format("the tree is {} nodes deep, tracing takes {} at most", bvh.depth, kMaxDepth));
  }
}

}  // namespace sightline

#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "bvh/bvh.h"
#include "core/scene/scene.h"

namespace sightline {

/// A triangle as leaves read it, in the order of Bvh::references. 40 bytes, no padding: for CPUs, where the
/// size of the scene in the cache decides.
struct TriangleRecord {
  float vertices[9];  ///< x, y, z of the three vertices
  uint32_t id;        ///< in file order
};
static_assert(sizeof(TriangleRecord) == 40);

/// The same in three 16-byte loads: for GPUs. 48 bytes.
struct TriangleRecordGpu {
  float vertices[3][4];  ///< x, y, z; the fourth of the first vertex holds the bits of the id
};
static_assert(sizeof(TriangleRecordGpu) == 48);

/// Records of the references bvh.references[first ... first + count).
/// out has room for all of them; ranges let big scenes be uploaded piece by piece.
void packTriangles(const Scene& scene, const Bvh& bvh, size_t first, std::span<TriangleRecord> out);
void packTriangles(const Scene& scene, const Bvh& bvh, size_t first, std::span<TriangleRecordGpu> out);

/// Triangles in leaves (Bvh::references) that a single ray's walk can number (cl_kernels/trace_single.cl).
constexpr uint64_t kMostGpuReferences = (1u << 28) - 8;

/// Throws Error if there are more than kMostGpuReferences.
void checkSingleRays(uint64_t references);

/// Throws Error if the tree is deeper than kMaxDepth or has no nodes: a traversal's stack would overflow.
void checkTraceable(const Bvh& bvh);

}  // namespace sightline

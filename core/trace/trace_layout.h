#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "bvh/bvh.h"
#include "core/scene/scene.h"

namespace sightline {

static_assert(sizeof(TriangleRecord) == 40 && sizeof(TriangleRecordGpu) == 48);

/// Records of the references bvh.references[first ... first + count). Those of a mesh are in its space, and
/// their ids count from the instance's first.
/// out has room for all of them; ranges let big scenes be uploaded piece by piece.
void packTriangles(const Scene& scene, const Bvh& bvh, size_t first, std::span<TriangleRecord> out);
void packTriangles(const Scene& scene, const Bvh& bvh, size_t first, std::span<TriangleRecordGpu> out);

/// A triangle's id in the record of a reference: what an instance's first id is added to.
uint32_t recordId(const Scene& scene, const Bvh& bvh, uint32_t reference);

/// Triangles in leaves (Bvh::references) that a single ray's walk can number (cl_kernels/trace_single.cl).
constexpr uint64_t kMostGpuReferences = uint64_t(kLeafFirstMask) + 1 - 8;

/// Throws Error if there are more than kMostGpuReferences.
void checkSingleRays(uint64_t references);

/// Throws Error if the tree is deeper than kMaxDepth or has no nodes: a traversal's stack would overflow.
void checkTraceable(const Bvh& bvh);

}  // namespace sightline

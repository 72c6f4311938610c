// What the Vulkan shaders of a launch read: the one struct that the host fills in for every launch. C++ and
// GLSL (scalar layout); addresses are device addresses of buffers.
#ifndef SL_LAUNCH_H
#define SL_LAUNCH_H
#include "core/shared/stage_launch.h"
SL_NAMESPACE_BEGIN

/// Neighbouring leaves that are drawn or left out together. Smaller ones fit a view's edge better, but a draw
/// costs even where it is empty.
SL_CONST uint kChunkTriangles = 2048u;
/// Floats of the box around a chunk: lowest and highest corner.
SL_CONST uint kBoxFloats = 6u;

SL_STRUCT(VulkanLaunch) {
  StageLaunch numbers;
  SL_ADDRESSES(SL_STAGE_BUFFERS, kStageBuffers)
  // The scene. A leaf is a place in the order in which the driver got the triangles.
  uint64 tlas;         ///< acceleration structure
  uint64 part_starts;  ///< uint[]: first leaf of each instance in the top-level structure
  uint64 part_ids;     ///< uint[]: what is added to the ids of its leaves
  uint64 part_places;  ///< uint[]: the instance that places them; kNoTriangle: they are in place
  uint64 instances;    ///< InstanceRecord[] by id
  uint64 leaf_ids;     ///< uint[]: leaf -> triangle id
  uint64 corners;      ///< float[9] a leaf
  uint64 surfaces;     ///< uint[]: core/shared/surface.h, in leaf order; 0: all are opaque from both sides
  // Hemicubes.
  uint64 hemicube;         ///< ViewFrame[5] of the hemicube that is drawn
  uint64 hemicubes;        ///< ViewFrame[5] a hemicube of the batch that is collected; 0: it was traced
  uint64 chunk_bounds;     ///< float[kBoxFloats] a chunk: the box around it
  uint64 draws;            ///< VkDrawIndirectCommand[] a view of a chunk each
  uint64 raster_leaves;    ///< uint[] a pixel of the hemicube's images: leaf or kNoTriangle
  uint raster_resolution;  ///< of a hemicube's images
  uint raster_first;       ///< index in the batch of the hemicube's first sample
  uint chunk_count;
  uint triangle_count;  ///< of the scene
  uint instance_count;  ///< of the scene; 0: it is plain
  float raster_near;    ///< distance of the near plane
};

SL_NAMESPACE_END
#endif

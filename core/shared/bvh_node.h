// The 2-wide tree and its triangles, as packets of rays and GPUs read them.
#ifndef SL_BVH_NODE_H
#define SL_BVH_NODE_H
#include "core/shared/language.h"
SL_NAMESPACE_BEGIN

/// Inner nodes on a path at most, whatever the input: a walk of the 2-wide tree leaves one sibling of each on
/// its stack. A macro, since OpenCL C takes no constant for the size of an array.
#define SL_MAX_DEPTH 96

/// Two children a node, with their boxes. 64 bytes.
SL_STRUCT(BvhNode2) {
  vec4 x;  ///< low and high of child 0, low and high of child 1
  vec4 y;
  vec4 z;
  uint child[2];  ///< inner: index of the node; leaf: index of the first reference
  uint count[2];  ///< references in the leaf; 0: an inner node
};

/// A triangle as leaves read it, in the order of Bvh::references. 40 bytes, no padding: for CPUs, where the
/// size of the scene in the cache decides.
SL_STRUCT(TriangleRecord) {
  float vertices[9];  ///< x, y, z of the three vertices
  uint id;            ///< in file order
};

/// The same in three 16-byte loads: for GPUs. 48 bytes.
SL_STRUCT(TriangleRecordGpu) {
  vec4 v0;  ///< xyz; w: bits of the id
  vec4 v1;  ///< xyz; w = 0
  vec4 v2;
};

/// Corners of a triangle as drivers' trees read them: nine floats.
SL_CONST uint kCornerBytes = 36u;

// A leaf in a word, as a single ray's walk keeps it: a bit, its references less one (3 bits), the first of
// them.
SL_CONST uint kLeafBit = 0x80000000u;
SL_CONST uint kLeafCountShift = 28u;
SL_CONST uint kLeafFirstMask = 0x0fffffffu;

SL_NAMESPACE_END
#endif

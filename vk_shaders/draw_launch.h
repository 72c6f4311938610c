// What the shaders that draw read. C++ and GLSL (scalar layout); addresses are device addresses of buffers.
#ifndef SL_DRAW_LAUNCH_H
#define SL_DRAW_LAUNCH_H
#include "core/shared/camera.h"
SL_NAMESPACE_BEGIN

/// No drawable: the id of a pixel that shows nothing.
SL_CONST uint kNoDrawable = 0xffffffffu;
/// Of a pixel that a cell's list drew: its one draw does not know.
SL_CONST uint kSomeDrawable = 0xfffffffeu;

/// A frame and the scene that it shows. A slot is a place in the order in which triangles are drawn.
SL_STRUCT(DrawLaunch) {
  Camera camera;
  uint64 positions;  ///< float[3] a vertex
  uint64 indices;    ///< uint[3] a slot: its vertices
  uint64 surfaces;   ///< uint[]: core/shared/surface.h, in the order of slots; 0: nothing has holes
};

/// What is drawn or not as a whole by a method on the GPU: a drawable or a meshlet.
SL_STRUCT(CullUnit) {
  vec4 low;   ///< xyz: its box
  vec4 high;  ///< xyz
  uvec4 run;  ///< first slot, triangles, drawable; first word of its meshlet
};

// What is known of a unit (CullLaunch::states).
SL_CONST uint kUnitSeen = 1u;   ///< by the last test; kept between frames
SL_CONST uint kUnitDrawn = 2u;  ///< early in this frame
SL_CONST uint kUnitNext = 4u;   ///< to be drawn by the list that is being written
SL_CONST uint kUnitAsked = 8u;  ///< its box is to be drawn

// Tests of cull_units.comp.
SL_CONST uint kTestBefore = 0u;   ///< what was seen in the frame before, and has a pixel
SL_CONST uint kTestPyramid = 1u;  ///< what the pyramid does not hide
SL_CONST uint kTestAsk = 2u;      ///< whose boxes are to be drawn
SL_CONST uint kTestBoxes = 3u;    ///< whose boxes have shown

/// Units of a block: neighbours that a group of an invocation each tests.
SL_CONST uint kCullBlock = 256u;
/// Words of a draw in a list: VkDrawIndexedIndirectCommand, or VkDrawIndirectCommand and an unused one.
SL_CONST uint kDrawWords = 5u;
/// Words of a list's head (CullLaunch::heads): draws, x, y, z groups of meshlets, triangles, drawables or
/// meshlets.
SL_CONST uint kHeadWords = 8u;
SL_CONST uint kHeadTriangles = 4u;
/// Groups in a row of the grid of meshlets.
SL_CONST uint kMeshletRow = 32768u;

/// What a method on the GPU keeps. Units of one kind (opaque, masked, blended) follow each other.
SL_STRUCT(CullLaunch) {
  uint64 units;         ///< CullUnit[]
  uint64 states;        ///< uint[] a unit: kUnit...
  uint64 block_counts;  ///< uint[blocks] a list: of its units that are next, by block
  uint64 draws;         ///< uint[kDrawWords] a draw; of one list those of its first unit on
  uint64 listed;        ///< uint[]: numbers of the units in a list of meshlets
  uint64 heads;         ///< uint[kHeadWords] a list
  uint64 pyramid;       ///< float[] (core/shared/pyramid.h)
  uint64 candidates;    ///< uint[]: a bit a drawable: whether it may be drawn; 0: all may
  uint64 meshlets;  ///< uint[]: of each meshlet how many vertices it has, their numbers, a word of corners a
                    ///< triangle
  uint64 order;     ///< uint[]: blended units, the farthest first
  uint blocks;      ///< of all units
  float shrink;     ///< of guardBox, and pixels that the pyramid's test takes off: 0 but for tests of tests
};

/// Numbers of a dispatch over units.
///   x: first unit, y: units, z: list, w: test (cull_units.comp) or kind of draw (write_draws.comp)
SL_STRUCT(DrawPush) {
  uint64 launch;  ///< DrawLaunch
  uint64 other;   ///< CullLaunch, or what the shader says
  uvec4 numbers;
};

// Kinds of draws.
SL_CONST uint kDrawIndexed = 0u;
SL_CONST uint kDrawPlain = 1u;  ///< three vertices a slot, no index
SL_CONST uint kDrawMeshlets = 2u;
SL_CONST uint kDrawOrdered = 3u;  ///< plain, in CullLaunch::order, empty where a unit is not to be drawn

SL_NAMESPACE_END
#endif

#pragma once
#include <memory>

#include "core/draw/cull_method.h"
#include "core/draw/draw_scene.h"
#include "core/draw/schedule.h"

// The methods that cull by boxes and occlusion queries. The scene must outlive them. All but cullLate draw
// all that covers a pixel of the frame.
namespace sightline {

/// Draws everything, in the order of drawables.
std::unique_ptr<CullMethod> cullNothing(const DrawScene& scene);

/// Draws what the image may show (Frustum), going down the tree, nearer children first.
std::unique_ptr<CullMethod> cullFrustum(const DrawScene& scene);

/// Hierarchical stop-and-wait: front to back, a query a node; waits for its answer, then goes down or draws.
/// Based on: M. Wimmer and J. Bittner, Hardware Occlusion Queries Made Useful, GPU Gems 2, 2005, chapter 6.
std::unique_ptr<CullMethod> cullStopAndWait(const DrawScene& scene, const Schedule& schedule = {});

/// Coherent hierarchical culling (J. Bittner, M. Wimmer, H. Piringer and W. Purgathofer, 2004): queries for
/// leaves and for nodes that were hidden; leaves that were visible are drawn without waiting for theirs.
std::unique_ptr<CullMethod> cullChc(const DrawScene& scene, const Schedule& schedule = {});

/// What CHC++ does to need fewer queries, and the Vulkan version's measures to need fewer submits. As it
/// stands it is opti-chc++; plainChc() is the version without those measures.
struct ChcOptions {
  uint32_t batch_size = 50;     ///< hidden nodes wait until more than so many are there to be asked about
  uint32_t assumed_frames = 5;  ///< a visible leaf is not asked about for so many frames; where it becomes
                                /// < visible, for 0 to so many (jitter)
  bool multi_queries = true;    ///< nodes that are likely still hidden share a query
  bool tight_bounds = true;     ///< BoxTree::tightOf in place of a node's own box
  bool c_queue = true;   ///< nodes of failed multiqueries wait for the next batch, not asked about at once
  bool batching = true;  ///< draws and the queries after them in one submit, re-tests in one submit a wait
  bool late_issue =
      true;  ///< what is left is asked about when no queries are under way either (second condition)
};
/// CHC++ (O. Mattausch, J. Bittner and M. Wimmer, 2008) in Vulkan without those measures.
ChcOptions plainChc();

/// CHC++ and Opti-CHC++ (M. Pernsteiner's thesis, chapter 4), by options.
std::unique_ptr<CullMethod> cullChcPlus(const DrawScene& scene, const ChcOptions& options,
                                        const Schedule& schedule = {});

/// Draws what was visible in the last frame, and what was not asked about then; asks about everything in the
/// image for the next. So what comes into view is missing for a frame: engines that do so call it popping.
std::unique_ptr<CullMethod> cullLate(const DrawScene& scene);

}  // namespace sightline

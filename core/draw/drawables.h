#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "bvh/axis_box.h"
#include "core/scene/scene.h"

namespace sightline {

/// What a triangle does to what is behind it, in the order in which a frame draws the kinds.
enum class AlphaKind : uint8_t {
  opaque,   ///< hides all
  masked,   ///< has holes: writes depth where it holds, but is drawn after all queries (thesis 3.2, 4.3)
  blended,  ///< glass: tests depth, writes none; drawn last, the farthest first
};

/// What is drawn or not as a whole: an object of the scene, or a part of one.
struct Drawable {
  uint32_t first_triangle = 0;  ///< in Drawables::triangles
  uint32_t triangle_count = 0;  ///< at least 1
  uint32_t object = 0;          ///< in Scene::objects
  AlphaKind alpha = AlphaKind::opaque;
  AxisBox box;  ///< of its triangles' corners (Scene::corners), tight
};

/// A scene cut into what is drawn: every triangle is in exactly one drawable.
struct Drawables {
  std::vector<Drawable> list;       ///< in the order of objects; of one object opaque, masked, blended
  std::vector<uint32_t> triangles;  ///< ids; each drawable's run is in the order in which it is drawn

  std::span<const uint32_t> trianglesOf(uint32_t drawable) const {
    const Drawable& d = list[drawable];
    return {triangles.data() + d.first_triangle, d.triangle_count};
  }
};

/// Most triangles of a drawable, unless asked for otherwise.
inline constexpr uint32_t kDefaultSplit = 2048;

struct PartitionOptions {
  uint32_t split =
      kDefaultSplit;  ///< objects with more triangles are cut into parts of at most so many, which lie
                      /// < together (subtrees of a tree over the object's triangles); 0: never cut
  int threads = 0;    ///< 0: all cores; the result does not depend on it
};

/// Objects with triangles of several kinds are cut by kind first. The same scene and split give the same
/// result. Throws std::bad_alloc.
Drawables partitionScene(const Scene& scene, const PartitionOptions& options = {});

/// Bounds of all boxes. The list must not be empty.
AxisBox boundsOf(const Drawables& drawables);

}  // namespace sightline

#pragma once
#include "bvh/box_tree.h"
#include "core/draw/drawables.h"

namespace sightline {

/// What all methods that cull by boxes share: a tree over the drawables' boxes. A leaf's item is a drawable.
struct DrawScene {
  Drawables drawables;
  BoxTree tree;
};

/// partitionScene and a tree over its boxes; throws as they do.
DrawScene makeDrawScene(const Scene& scene, const PartitionOptions& options = {},
                        const TightBounds& tight = {});

/// The same over drawables that there are already.
DrawScene makeDrawScene(Drawables drawables, const TightBounds& tight = {}, int threads = 0);

}  // namespace sightline

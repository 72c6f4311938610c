#include "core/draw/draw_scene.h"

namespace sightline {

DrawScene makeDrawScene(const Scene& scene, const PartitionOptions& options, const TightBounds& tight) {
  return makeDrawScene(partitionScene(scene, options), tight, options.threads);
}

DrawScene makeDrawScene(Drawables drawables, const TightBounds& tight, int threads) {
  std::vector<AxisBox> boxes;
  boxes.reserve(drawables.list.size());
  for (const Drawable& d : drawables.list) boxes.push_back(d.box);
  return {std::move(drawables), buildBoxTree(boxes, tight, threads)};
}

}  // namespace sightline

#include "core/draw/cull_methods.h"
#include "core/draw/stateless_method.h"
#include "core/draw/visit_frustum.h"

namespace sightline {

std::unique_ptr<CullMethod> cullFrustum(const DrawScene& scene) {
  return statelessMethod(scene, {}, [&scene](FrameRecorder& frame, const Camera& camera) {
    frame.counts.node_visits = visitFrustum(scene.tree, camera, frame.guard().frustum(),
                                            [&](const BoxNode& leaf) { frame.draw(leaf.item); });
  });
}

}  // namespace sightline

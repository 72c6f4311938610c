#include "core/draw/cull_methods.h"
#include "core/draw/stateless_method.h"

namespace sightline {

std::unique_ptr<CullMethod> cullNothing(const DrawScene& scene) {
  return statelessMethod(scene, {}, [&scene](FrameRecorder& frame, const Camera&) {
    for (uint32_t d = 0; d < scene.drawables.list.size(); ++d) frame.draw(d);
  });
}

}  // namespace sightline

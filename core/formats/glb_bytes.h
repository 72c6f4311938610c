#pragma once
#include <functional>
#include <string>
#include <string_view>

#include "core/scene/scene.h"
#include "core/scene/scene_stream.h"

namespace sightline {

/// The scene as a GLB file, handed to `write` in a few pieces; loadScene returns the same positions,
/// triangles and objects of it, bit for bit; its offset is put back. name: of what is written, for errors.
/// Throws Error.
void writeGlb(const Scene& scene, const std::string& name,
              const std::function<void(std::string_view)>& write);

/// The same bytes of a scene that is made meanwhile.
void streamGlb(const SceneStream& stream, const std::string& name,
               const std::function<void(std::string_view)>& write);

}  // namespace sightline

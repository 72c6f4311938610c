#pragma once
#include <functional>
#include <string>
#include <string_view>

#include "core/scene/scene.h"

namespace sightline {

/// The scene as the text of an OBJ file, handed to `write` in pieces of about a MiB; loadScene returns the
/// same positions, triangles and objects of it, bit for bit; its offset is put back, which may round them.
/// name: of what is written, for errors. Throws Error.
void writeObj(const Scene& scene, const std::string& name,
              const std::function<void(std::string_view)>& write);

}  // namespace sightline

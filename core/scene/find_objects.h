#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/base/named_triangles.h"
#include "core/scene/scene.h"

namespace sightline {

/// The objects of the scene whose name is of one of the patterns (matchesGlob), in the scene's order, each
/// once. The name of a glTF node stands for all of its primitives: a pattern may be that of the part of a
/// name before any of its slashes. Throws Error (wrong usage) for a pattern that no object is of, with names
/// that are near; option: that it was given to, for the message.
std::vector<NamedTriangles> findObjects(const Scene& scene, std::span<const std::string> patterns,
                                        const std::string& option);

}  // namespace sightline

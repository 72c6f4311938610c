#pragma once
#include <filesystem>

#include "core/scene/scene.h"
#include "core/scene/scene_stream.h"

namespace sightline {

/// Writes .obj or .glb (by extension) so that loadScene returns the same positions, triangles and objects,
/// bit for bit. A GLB also holds what is single-sided, glass, and masks, each as an image of its own; an OBJ
/// of a scene with such surfaces is an error. Of a scene with masks
/// - vertices of masked triangles come back behind the others, those of each object for themselves (as
///   generateScene has them);
/// - places in an image come back as they are where 24 bits hold them: in images of up to 256 texels a side
///   those that came from texture coordinates in 0..1; others may move by less than a thousandth of a texel.
/// An object whose triangles are of several kinds (of an OBJ with glass, or with doors open) comes back as
/// several, NAME/0, NAME/1, ... Writes to a temporary name and renames. A GLB holds less than 4 GiB. Throws
/// Error.
void saveScene(const Scene& scene, const std::filesystem::path& file);

/// Writes a .glb: the bytes that saveScene writes of the same scene, which is made meanwhile and never held.
/// The objects' names must be such that saveScene takes them. Throws Error.
void saveGlb(const SceneStream& stream, const std::filesystem::path& file);

}  // namespace sightline

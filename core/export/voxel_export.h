#pragma once
#include <filesystem>
#include <glm/glm.hpp>

#include "core/voxel/voxel_faces.h"

namespace sightline {

/// Writes faces as binary PLY, four corners each. offset: of the scene (Scene::offset), put back; with one,
/// coordinates are doubles. By a temporary name (OutputFile). Throws Error, and as voxelMesh.
void savePly(const VoxelMesh& mesh, const glm::dvec3& offset, const std::filesystem::path& file);

/// Writes the set as OpenVDB: a float grid "density" (fog volume), active and 1 in the set, 0 elsewhere,
/// whose index (i, j, k) is the voxel with that lowest corner: its middle lies in the middle of the voxel.
/// Same set, same bytes. Throws Error, one that names libopenvdb-dev where it was built without.
void saveVdb(const VoxelGrid& grid, const glm::dvec3& offset, const std::filesystem::path& file);
/// Whether it was built with OpenVDB.
bool canSaveVdb();

}  // namespace sightline

#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/cell/view_cell.h"
#include "core/generate/scene_parts.h"
#include "core/path/camera_path.h"
#include "core/scene/scene_stream.h"

namespace sightline {

// The generators behind generate.h, a file each. Parts and cells of one scene come from the same layout,
// which depends on count and seed only; that is how cells know where free space is.

std::vector<ScenePart> cityParts(uint64_t triangles, uint64_t seed);
/// even: of repeatedCity, whose blocks are all of one size.
std::vector<ViewCell> cityCells(uint64_t triangles, uint64_t seed, bool even = false);
/// Walks through free space, of so many frames; even: as of cityCells.
CameraPath cityWalk(uint64_t triangles, uint64_t seed, uint32_t frames, bool even = false);
CameraPath canyonWalk(uint64_t triangles, uint64_t seed, uint32_t frames);
CameraPath plantWalk(uint64_t triangles, uint64_t seed, uint32_t frames);
CameraPath bistroWalk(uint64_t triangles, uint64_t seed, uint32_t frames);

std::vector<ScenePart> canyonParts(uint64_t triangles, uint64_t seed);
std::vector<ViewCell> canyonCells(uint64_t triangles, uint64_t seed);
// The scenes that can be made of few kinds of modules, repeated (bays, blocks of houses).
RepeatedScene repeatedCity(uint64_t triangles, uint64_t seed, uint32_t kinds);
RepeatedScene repeatedPlant(uint64_t triangles, uint64_t seed, uint32_t kinds);

SceneStream scanStream(uint64_t triangles, uint64_t seed, bool holes,
                       const std::function<void(uint32_t vertices, uint32_t of)>& measured);
std::vector<ViewCell> scanCells();
CameraPath scanWalk(uint32_t frames);

std::vector<ScenePart> plantParts(uint64_t triangles, uint64_t seed);
std::vector<ViewCell> plantCells(uint64_t triangles, uint64_t seed);
std::vector<ScenePart> bistroParts(uint64_t triangles, uint64_t seed);
std::vector<ViewCell> bistroCells(uint64_t triangles, uint64_t seed);

}  // namespace sightline

#pragma once
#include <cstdint>

#include "core/generate/mesh_builder.h"

namespace sightline {

// Steelwork and machines of the plant scene, in the builder's frame, y = 0 the floor. Level 0 is the coarsest
// and not empty unless said; the last level is kUnitLevels.
inline constexpr uint32_t kUnitLevels = 60;

/// A beam of I section along the frame's z axis from 0 to length; x across the flanges, centred.
void makeBeam(MeshBuilder& mesh, float length, float size, uint32_t level);

/// A floor of bars over [0, width] x [0, depth], its top at y = 0.
void makeGrating(MeshBuilder& mesh, float width, float depth, uint32_t level);

/// Posts and two rails along x from 0 to length. Level 0 and 1: nothing.
void makeRailing(MeshBuilder& mesh, float length, uint32_t level);

/// A vessel about the frame's y axis on legs, with a dome, nozzles and a ladder.
void makeTank(MeshBuilder& mesh, float radius, float height, uint64_t seed, uint32_t level);

/// A lying drum on saddles, along x from -length / 2 to length / 2.
void makeDrum(MeshBuilder& mesh, float radius, float length, uint32_t level);

/// A bank of thin tubes between two headers: length along x, rows up. Level 0: a box.
void makeTubeBank(MeshBuilder& mesh, glm::vec3 size, uint32_t level);

/// A pump with its motor on a plinth, 1.6 m along x. Level 0: nothing.
void makePump(MeshBuilder& mesh, uint32_t level);

/// A straight flight of steps of the width (x) that climbs along z: run and rise. Level 0: a slope.
void makeStair(MeshBuilder& mesh, float width, float run, float rise, uint32_t level);

/// A cable tray along z from 0 to length, 0.5 m wide in x. Level 0 and 1: nothing.
void makeCableTray(MeshBuilder& mesh, float length, uint32_t level);

}  // namespace sightline

#pragma once
// Frames and sets for tests of walks.
#include <string>

#include "core/draw/draw_scene.h"
#include "core/draw/make_camera.h"
#include "core/draw/pvs_units.h"
#include "core/generate/generate.h"
#include "core/walk/replay.h"

namespace sightline::test {

/// The walk of a generated scene.
inline WalkFrames generatedFrames(const std::string& scene, uint64_t triangles, uint32_t frames,
                                  glm::uvec2 size, const DrawScene& draw) {
  const CameraPath path = generateWalk(scene, triangles, 1, frames);
  const float near = nearDistance(boundsOf(draw.drawables));
  WalkFrames walk;
  for (uint32_t frame = 0; frame < path.frames(); ++frame) {
    const PathPlace at = placeAt(path, frame);
    walk.cameras.push_back(
        makeCamera(lookAt(at.eye, at.look, path.fov, size.x, size.y), size.x, size.y, near));
  }
  walk.cuts = path.cuts;
  return walk;
}

/// One cell that holds the world, and sees all of it.
inline PvsUnits unitsOfAll(const Scene& scene, const Drawables& drawables) {
  PvsFile pvs;
  pvs.triangle_count = scene.triangleCount();
  CellPvs cell;
  cell.cell = {"world", {0, 0, 0}, {1e5, 1e5, 1e5}, {0, 0, 0}};
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) cell.triangles.push_back(id);
  pvs.planned = {cell.cell};
  pvs.cells = {cell};
  return makePvsUnits(pvs, drawables);
}

}  // namespace sightline::test

#pragma once
#include "tests/support/boxes.h"

namespace sightline::testing_support {

/// A room of 6 x 3 x 6 metres of thin panels, 1 m wide, with gaps between them; a floor and a
/// ceiling that reach past the walls; some furniture; and all around, 5 m behind the walls, a mosaic. In
/// metres, the room's centre over the origin, its floor at y = 0.
struct LeakyRoom {
  Scene scene;
  uint32_t mosaic = 0;  ///< first of the mosaic's triangles: all behind are

  /// gap: between two panels; mosaic_steps: squares along a side of the mosaic's walls.
  explicit LeakyRoom(float gap, int mosaic_steps = 64) {
    SceneOfBoxes boxes;
    boxes.addBox({-20, -0.2f, -20}, {20, 0, 20});
    boxes.addBox({-20, 3, -20}, {20, 3.2f, 20});
    for (int side = 0; side < 4; ++side) {
      for (int panel = 0; panel < 6; ++panel) addPanel(boxes, side, panel, gap);
    }
    for (int i = 0; i < 24; ++i) {
      const float x = float(i % 6) - 2.5f, z = float(i / 6) - 1.5f;
      if (x * x + z * z < 1.2f) continue;  // the viewer's place
      boxes.addBox({x - 0.2f, 0, z - 0.2f}, {x + 0.2f, 0.5f + 0.01f * float(i), z + 0.2f});
    }
    const float step = 16.0f / float(mosaic_steps);
    for (int side = 0; side < 4; ++side) {
      for (int i = 0; i < mosaic_steps; ++i) {
        for (int k = 0; k < mosaic_steps / 4; ++k) {
          const vec3 low(float(i) * step - 8, float(k) * 3 / float(mosaic_steps / 4), 8);
          const vec3 u = turned(vec3(step, 0, 0), side), v(0, 3 / float(mosaic_steps / 4), 0);
          const uint32_t id = boxes.addRectangle(turned(low, side), u, v);
          if (mosaic == 0) mosaic = id;
        }
      }
    }
    scene = boxes.finish();
  }

 private:
  /// By quarters of a circle about y.
  static vec3 turned(vec3 p, int quarters) {
    for (int i = 0; i < quarters; ++i) p = vec3(p.z, p.y, -p.x);
    return p;
  }

  static void addPanel(SceneOfBoxes& boxes, int side, int panel, float gap) {
    // The first begins in the corner, where the last of the wall beside it ends.
    const float from = float(panel) - 3 + (panel == 0 ? 0 : gap / 2);
    const float to = float(panel) - 2 - (panel == 5 ? 0 : gap / 2);
    boxes.addRectangle(turned(vec3(from, 0, 3), side), turned(vec3(to - from, 0, 0), side), {0, 3, 0});
  }
};

}  // namespace sightline::testing_support

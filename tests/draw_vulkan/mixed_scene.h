#pragma once
// A city with every kind of surface.
#include "core/scene/surfaces.h"
#include "tests/draw_vulkan/drawn_city.h"

namespace sightline::drawing_cases {

/// Of every five objects one of glass, one with holes; of every seven one that only its front shows, if asked
/// for.
inline Scene withSurfaces(Scene scene, bool sides) {
  scene.surfaces.words.assign(scene.triangles.size(), 0);
  for (size_t o = 0; o < scene.objects.size(); ++o) {
    for (uint32_t i = 0; i < scene.objects[o].triangle_count; ++i) {
      uint32_t& word = scene.surfaces.words[scene.objects[o].first_triangle + i];
      if (o % 5 == 2) word = kSurfaceGlass;
      if (o % 5 == 4) word = kSurfaceMasked;
      if (sides && o % 7 == 3) word |= kSurfaceFrontOnly;
    }
  }
  // One mask of 4 texels, two of them holes.
  scene.surfaces.texels = {0b0110u};
  scene.surfaces.masks.push_back({{2, 2, kWrapClamp + 4 * kWrapClamp, 0}});
  scene.surfaces.masked.push_back(
      {{kTexelOffset, kTexelOffset, kTexelOffset + 2, kTexelOffset}, {kTexelOffset, kTexelOffset + 2, 0, 0}});
  return scene;
}

}  // namespace sightline::drawing_cases

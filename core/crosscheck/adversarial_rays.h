#pragma once
#include <span>

#include "core/crosscheck/ray_kinds.h"
#include "core/sampling/ray_random.h"

namespace sightline {

/// What adversarial rays are made of.
struct AdversarialScene {
  const Scene& scene;
  std::span<const Face> faces;        ///< of the view cell, where most of them start
  std::span<const PvsEntry> visible;  ///< most of them aim at these
  float reach;                        ///< size of scene and cell
};

/// A ray of a kind from kVertex on. Aimed ones have their target, as far as floats go, at t = 1.
Ray adversarialRay(RayKind kind, const AdversarialScene& scene, RayRandom& random);

}  // namespace sightline

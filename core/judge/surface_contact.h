#pragma once
#include "core/judge/judge_ray.h"
#include "core/scene/scene.h"

namespace sightline {

/// Whether a ray that meets the triangle meets something there: not a hole of its mask, not the back of what
/// has only a front. Without rounding: the texel is that of the exact point in the image, whose places of the
/// corners are those of the record; on a border between texels the one to the right or below. In double with
/// error bounds where that decides, else in exact numbers.
bool meetsSurface(const Scene& scene, uint32_t triangle, const JudgeRay& ray, const JudgeTriangle& shape);

}  // namespace sightline

#pragma once
#include <glm/glm.hpp>

#include "core/shared/types.h"

namespace sightline {

/// A ray for the judge: doubles, so that it holds every ray of floats exactly, and rays moved by less than a
/// float step. Direction not normalised, not zero; all numbers finite and of a float's magnitude.
struct JudgeRay {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0};
};

inline JudgeRay judgeRay(const Ray& ray) {
  return {glm::dvec3(ray.origin), glm::dvec3(ray.direction)};
}

/// Corners of a triangle, floats in doubles.
struct JudgeTriangle {
  glm::dvec3 a{0.0}, b{0.0}, c{0.0};
};

/// Closed interval that holds an exact number.
struct DoubleRange {
  double low = 0, high = 0;
};

/// Largest absolute component.
inline double maxAbs(const glm::dvec3& v) {
  return glm::max(glm::max(glm::abs(v.x), glm::abs(v.y)), glm::abs(v.z));
}

}  // namespace sightline

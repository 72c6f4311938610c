#include "core/draw/node_queue.h"

#include <algorithm>
#include <cmath>

namespace sightline {

double squaredDistance(const Camera& camera, const AxisBox& box) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double eye = camera.eye[axis];
    const double away = std::max(std::max(box.low[axis] - eye, eye - box.high[axis]), 0.0);
    sum += away * away;
  }
  return sum;
}

}  // namespace sightline

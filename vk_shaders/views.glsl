// Images and hemicubes: where they are taken from.
#include "core/shared/view_ray.h"

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Views {
  ViewFrame at[];
};

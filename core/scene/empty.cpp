#include "core/scene/scene.h"
#include "core/scene/view_cell.h"
#include "core/device/device.h"
#include "core/pvs/pvs.h"

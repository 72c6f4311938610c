// The one OpenCL program: every kernel, in one translation unit. Build options choose the variant.
#include "core/shared/stage_params.h"

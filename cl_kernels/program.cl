// The one OpenCL program: every kernel, in one translation unit. Build options choose the variant.
#include "cl_kernels/list_stages.cl"
#include "cl_kernels/stages.cl"
#include "cl_kernels/views.cl"

// The one OpenCL program: every kernel, in one translation unit. Build options choose the variant.
#include "cl_kernels/border_batch.cl"
#include "cl_kernels/collect.cl"
#include "cl_kernels/gvs_border.cl"
#include "cl_kernels/stages.cl"
#include "cl_kernels/views.cl"

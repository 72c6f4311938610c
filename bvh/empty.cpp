#include "bvh/bvh.h"

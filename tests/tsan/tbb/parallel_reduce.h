#pragma once
#include "tests/tsan/plain_threads.h"

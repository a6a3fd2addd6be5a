// Stand-in for oneTBB, see tbb/threads.h.
#pragma once

#include "../../tbb/global_control.h"

// Private to this box: what makes loops over lanes SIMD code of the CPU at hand. The files that use it are compiled
// with -fno-math-errno -fno-trapping-math.
#pragma once

#define PELAGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

/// Before a loop over lanes whose arrays do not overlap.
#if defined(__clang__)
#define PELAGE_EACH_LANE _Pragma("clang loop interleave(disable)")
#else
#define PELAGE_EACH_LANE _Pragma("GCC ivdep")
#endif

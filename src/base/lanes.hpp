// Functions whose loops over lanes are compiled for each width of SIMD registers.
#pragma once

// The choice is made once, when the program is loaded. The sanitizers are not ready by then.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define GOINGRATE_WIDEST_LANES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define GOINGRATE_WIDEST_LANES
#endif

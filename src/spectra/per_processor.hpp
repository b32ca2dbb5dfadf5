// Functions that are compiled twice, for any processor and for those with more. Private to the
// spectra room.
#pragma once

// GOINGRATE_PER_PROCESSOR("avx2") before a function: the program takes the version for the
// processor it finds itself on. The arithmetic is that of the source in both (nothing is
// contracted), so the results are the same bit for bit. Where the C library cannot choose (not
// glibc) there is the plain one alone. What such a function calls must be inlined to gain by it.
#if defined(__x86_64__) && defined(__GLIBC__)
#define GOINGRATE_PER_PROCESSOR(feature) __attribute__((target_clones(feature, "default")))
#else
#define GOINGRATE_PER_PROCESSOR(feature)
#endif
#define GOINGRATE_INLINE __attribute__((always_inline))

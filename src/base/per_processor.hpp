// Functions that are compiled twice: for any processor, and for those with a further set of
// instructions.
#pragma once

// GOINGRATE_PER_PROCESSOR("avx2") before a function: the program picks the version for the
// processor that it runs on. The arithmetic is that of the source in both (nothing is
// contracted), so the results are the same bit for bit. If the C library cannot choose (not glibc),
// there is only the plain version. Functions called by such a function gain only if inlined.
// ThreadSanitizer is not ready when the choice is made.
#include <cstdlib> // __GLIBC__

#if defined(__SANITIZE_THREAD__)
#define GOINGRATE_ONE_VERSION
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define GOINGRATE_ONE_VERSION
#endif
#endif

#if defined(__x86_64__) && defined(__GLIBC__) && !defined(GOINGRATE_ONE_VERSION)
#define GOINGRATE_PER_PROCESSOR(feature) __attribute__((target_clones(feature, "default")))
#else
#define GOINGRATE_PER_PROCESSOR(feature)
#endif
#define GOINGRATE_INLINE __attribute__((always_inline))

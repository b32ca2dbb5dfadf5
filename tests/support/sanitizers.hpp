// Limits under a sanitizer: it needs more memory than any limit that a test could set, and runs at
// a fraction of the usual speed.
#pragma once

#include <gtest/gtest.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define GOINGRATE_NEEDS_MEMORY_LIMITS() GTEST_SKIP() << "a sanitizer needs terabytes of addresses"
#define GOINGRATE_NEEDS_THE_USUAL_PACE() GTEST_SKIP() << "a sanitizer takes several times as long"
#else
#define GOINGRATE_NEEDS_MEMORY_LIMITS() static_cast<void>(0)
#define GOINGRATE_NEEDS_THE_USUAL_PACE() static_cast<void>(0)
#endif

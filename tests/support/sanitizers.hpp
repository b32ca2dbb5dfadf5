// What a sanitizer does not allow: its own memory is larger than any limit that a test could set.
#pragma once

#include <gtest/gtest.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define GOINGRATE_NEEDS_MEMORY_LIMITS() GTEST_SKIP() << "a sanitizer needs terabytes of addresses"
#else
#define GOINGRATE_NEEDS_MEMORY_LIMITS() static_cast<void>(0)
#endif

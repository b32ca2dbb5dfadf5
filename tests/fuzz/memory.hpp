// Counts allocated memory, so that a fuzzer can compare it with the size of its input.
#pragma once

#include <cstddef>

namespace goingrate::fuzz {

/// Bytes allocated and not yet freed, the most since the last reset. Counted by the sanitizer.
std::size_t peak_bytes();
void reset_peak();

} // namespace goingrate::fuzz

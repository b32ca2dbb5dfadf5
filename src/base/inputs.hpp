// The files that are read, which no output may replace.
#pragma once

#include <string>

namespace goingrate {

/// Throws ArgumentError("output", ...) if `path` is a file that must be kept; "-" is standard
/// output.
void refuse_input(const std::string& path);

} // namespace goingrate

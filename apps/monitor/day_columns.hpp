// The columns of a day's file in an archive.
#pragma once

#include "goingrate/log/reading.hpp"
#include "goingrate/log/writing.hpp"

#include <optional>
#include <string>

namespace goingrate::apps {

inline constexpr int archive_decimals = 9; ///< of a second

/// The columns of a day's file; nothing if it has no header.
std::optional<NativeColumns> header_of(const std::string& path);
/// The values that have no column.
EventValues beside(const EventValues& values, const NativeColumns& columns);

} // namespace goingrate::apps

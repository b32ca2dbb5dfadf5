// Finds the separator of a log's fields, and whether its commas are decimal points.
#pragma once

#include "log_head.hpp"

#include <string_view>
#include <vector>

namespace goingrate {

std::size_t count_fields(std::string_view line, char separator);

/// Finds the field separator and the decimal point from `lines` and sets them in `head`. With
/// `decimal_comma`, the decimal point is known to be a comma (Formats.ReadsInTheWild).
void settle_separators(LogHead& head, const std::vector<HeadLine>& lines, bool decimal_comma);

} // namespace goingrate

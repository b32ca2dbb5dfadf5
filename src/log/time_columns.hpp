// Finds the columns of a table that hold the time.
#pragma once

#include "log_head.hpp"

#include "goingrate/log/layout.hpp"

#include <span>

namespace goingrate {

/// Whether a column counts the lines: whole numbers that rise by one.
bool counts_lines(const ColumnSample& sample);

/// Sets the time, and the date where it has a column of its own, of a table without names: the
/// first column of dates and times of day; else of numbers that rise and do not count the lines;
/// else the first.
void guess_time(std::span<const ColumnSample> samples, Layout& layout);

/// Decides which columns named as times are read: a column of dates alone is joined with the column
/// of times of day, or ignored if there is none; of several others the first is used. Returns the
/// places of the time columns that are not read.
std::vector<std::size_t> settle_named_times(std::span<const ColumnSample> samples, Layout& layout);

} // namespace goingrate

// Reading logs.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <string>
#include <string_view>

namespace goingrate {

/// What the reader may be told instead of finding out.
struct ReadingOptions {
  std::optional<LogFormat> format;
  std::optional<double> nominal_period_s;
};

/// Reads the whole text of a log; `source` names it in messages.
///
/// The format is found from the first line of data and said in `assumptions`. A line that cannot be
/// used is left out and listed in `issues`; order is restored by sorting, also listed.
/// Amplitudes outside 0 to pi rad are taken as unknown, times beyond 4e18 s left out; both are
/// told. Throws InputError (file, line, column, found, expected) if the text is empty, binary, of
/// no known format, if fewer than half of its lines can be used, or fewer than three events are
/// found.
ClockLog read_log(std::string_view text, const std::string& source,
                  const ReadingOptions& options = {});

/// Reads a column of numbers, one a line ('#' lines are comments; "nan" is a gap), as phase and
/// frequency data come. Throws InputError at the first line that is no number, and for fewer than
/// three numbers.
std::vector<double> read_numbers(std::string_view text, const std::string& source);

/// Reads a file, or standard input for "-". Throws InputError if it cannot be opened.
std::string read_text(const std::string& path);

/// Moves every event from the sensor's edge to the vertical:
/// t - (T0 / 2 pi) asin(angle / amplitude), with each event's own amplitude. `edge_angle_rad` is
/// the angle at which the sensor sees the rising pendulum: for the leading edge of a centred flag
/// minus half the flag's width.
///
/// The next term, of order epsilon and amplitude^2, is below 1e-4 of the correction. Events without
/// an amplitude above |angle| become issues and are removed. Trinity clock, 2013-03-30: the robust
/// scatter of its periods falls from 44.5 to 31.6 us (TrinityTest.EdgeCorrectionLowersTheNoise).
void correct_edge_to_centre(ClockLog& log, double edge_angle_rad, double period_s);

} // namespace goingrate

// The layout of the text of a log: its separators, and the meaning of its columns.
#pragma once

#include "goingrate/base/instant.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// The kinds of logs that are read; data/guide/formats.md shows a line of each.
enum class LogFormat {
  native,      ///< '#' header, then CSV with named columns
  timestamps,  ///< a time per line: seconds, another unit, MJD, date and time, a counter
  clock_error, ///< "label error amplitude_mrad": label s, error s (positive: fast), amplitude mrad
  periods,     ///< a period per line
  phase,       ///< the clock's error a line, one every tau0: Stable32, SigmaTheta .xtt
  frequency,   ///< relative frequency a line, one every tau0: SigmaTheta .ykt
  ticc,        ///< TAPR TICC: "time chA"
  ticc_interval, ///< TAPR TICC: "interval TI(A->B)"
  table,         ///< columns with names
  angle,         ///< samples of the angle; crossings are found by local fits
  ticktock,      ///< an oscillation a line: four intervals between a light gate's edges
  xy,            ///< samples of the bob's position: time, x, y; read as angles about the centre
  sound,         ///< a recording: WAV, FLAC, OGG; ticks are found by find_ticks
};

/// The meaning of a column.
enum class ColumnRole : std::uint8_t {
  ignored,
  time,        ///< of the event or sample
  date,        ///< the time of day stands in the next column
  period,      ///< from the event before to this one
  half_period, ///< the same, of half a swing
  clock_error, ///< s, positive: fast
  phase,       ///< the same, of events that come every tau0
  frequency,   ///< relative
  amplitude,
  angle,
  position,     ///< sideways displacement; its unit does not matter
  height,       ///< with it, in the same unit: both give the angle about the centre of the arc
  width,        ///< dark time of the flag, s
  tick_dark,    ///< cycles of a counter: the flag in the gate on its way up,
  tick_light,   ///< then out of it until it returns,
  tock_dark,    ///< in it on its way down,
  tock_light,   ///< and out of it until the next oscillation
  counter_rate, ///< Hz, of that counter
  edge,         ///< up or down; of a gate's two edges up-in, up-out, down-in, down-out
  temperature,
  pressure,
  humidity,
  channel, ///< chA, chB, TI(A->B)
};

/// One column.
struct LogColumn {
  ColumnRole role = ColumnRole::ignored;
  TimeUnit unit{};    ///< of a time
  double scale = 1.0; ///< factor that turns other numbers into rad, s, degrees C, mbar or %
  double offset = 0.0; ///< added after that, for degrees of temperature
  std::string name{};
};

/// The layout of one log.
struct Layout {
  LogFormat format = LogFormat::timestamps;
  char separator = ' ';         ///< ' ' stands for any run of blanks and tabs
  char point = '.';             ///< decimal point
  std::uint32_t first_line = 1; ///< line of the first data
  std::vector<LogColumn> columns;
  bool calendar = false;        ///< times are dates or times of day
  bool month_first = false;     ///< in dates such as 03/04/2013
  std::optional<double> wrap_s; ///< after which times start again from 0
  double tau0_s = 1.0;          ///< of phase, frequency and intervals
  double counter_hz = 0.0;      ///< rate of a counter, if no column has it
  std::string channel;          ///< the channel of a TICC that is read; others are left out
  bool newest_first = false;
  /// Where periods are added up: a column of coarser times, which shows pauses.
  std::optional<std::size_t> coarse_time;
  bool date_begins_run = false; ///< the date is that of a run, the times count from it
  double label_step_s = 0.0;    ///< between the labels of clock errors; 0: none
  std::optional<std::size_t> swinging; ///< of samples of an angle: another column that swings

  /// The first column of a role.
  [[nodiscard]] std::optional<std::size_t> find(ColumnRole role) const;
};

std::string_view name_of(LogFormat format); ///< as --format takes it
std::string_view in_words(LogFormat format);
std::string_view name_of(ColumnRole role); ///< as --column takes it
std::optional<LogFormat> format_named(std::string_view name);
std::optional<ColumnRole> role_named(std::string_view name);
std::vector<std::string> format_names();
std::vector<std::string> role_names();
/// The unit of time of that name: s, ms, us, ns, min, h, d, mjd and what else headers say.
std::optional<TimeUnit> unit_named(std::string_view name);

} // namespace goingrate

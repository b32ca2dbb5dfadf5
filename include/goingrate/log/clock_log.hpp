// A log as it was read: its events, the assumptions made, and the faults found.
#pragma once

#include "goingrate/base/errors.hpp"
#include "goingrate/base/instant.hpp"
#include "goingrate/log/layout.hpp"
#include "goingrate/log/tides.hpp"
#include "goingrate/sound/ticks.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// The direction of the pendulum.
enum class Edge : std::uint8_t { up, down };

/// The kind of an event, as found when the beats were numbered.
enum class BeatFlag : std::uint8_t {
  good,     ///< an upward crossing with its cycle number (or not numbered yet)
  spurious, ///< no crossing of its own: a double trigger or a false one
  down,     ///< a downward crossing, numbered with the upward crossing before it
  rival,    ///< another event that fits the cycle as well: either may be the crossing
  bounce,   ///< follows an edge so closely that it is a bounce of the contact
};

/// One event of a log: as it was read and, once numbered, with its cycle. 40 bytes, so that a year
/// of seconds fits in memory.
struct Beat {
  Instant time;
  std::int64_t cycle = 0; ///< 0 for the first good beat; of a spurious event: the beat before it
  double amplitude_rad = std::numeric_limits<double>::quiet_NaN(); ///< NaN where the log has none
  std::uint32_t line = 0;                                          ///< line of the file, from 1
  std::uint16_t segment = 0; ///< within one segment the count of cycles is certain
  BeatFlag flag = BeatFlag::good;
  Edge edge = Edge::up;
};
static_assert(sizeof(Beat) == 40);

/// An event that is not numbered yet.
inline Beat event_at(const Instant& time, Edge edge = Edge::up, std::uint32_t line = 0,
                     double amplitude_rad = std::numeric_limits<double>::quiet_NaN()) {
  return {time, 0, amplitude_rad, line, 0, BeatFlag::good, edge};
}

/// The kinds of faults of a line.
enum class IssueKind : std::uint8_t {
  unreadable,   ///< a field that cannot be read as what its column holds
  missing,      ///< an empty field, too few or too many fields
  no_value,     ///< NaN, or all nines, in a place that needs a number
  out_of_range, ///< an impossible number
  binary,       ///< bytes that do not occur in text
  truncated,    ///< a last line that was cut short
  out_of_order, ///< a time before the one before
  label_jitter, ///< a label written a step early or late
  gap,          ///< a place left empty on purpose
  header,       ///< a header in the middle, or one that does not fit the columns
  incomplete,   ///< one edge of a passage without the other
  repeated,     ///< a copy of another line
};
std::string_view name_of(IssueKind kind);

/// A fault of one line, or the same fault of a run of lines, and what was done about it. If more
/// than one line in 25 (and more than 500) are faulty, those of one kind become one entry, even
/// with good lines between them: the list must not outgrow the log.
struct LineIssue {
  std::size_t line = 0;
  std::size_t column = 0;
  IssueKind kind = IssueKind::unreadable;
  std::string found; ///< in the first of the lines
  std::string action;
  std::size_t last_line = 0; ///< of the run; `line` if it is one
  std::size_t lines = 1;     ///< at fault
  bool scattered = false;    ///< there are good lines between the first and the last of the run
};

/// Further columns of the log: each is empty, or has one value per event, NaN where unknown.
struct EventColumns {
  std::vector<double> width_s{};       ///< dark time of the flag
  std::vector<double> sigma_s{};       ///< standard deviation of the time
  std::vector<double> temperature_c{}; ///< degrees Celsius
  std::vector<double> pressure_mbar{};
  std::vector<double> humidity_percent{}; ///< relative

  /// Every column.
  std::array<std::vector<double>*, 5> all() {
    return {&width_s, &sigma_s, &temperature_c, &pressure_mbar, &humidity_percent};
  }
};

/// Data on a grid: no beats, but the error of the clock at equal intervals.
struct GridData {
  double tau0_s = 1.0;         ///< the interval
  std::vector<double> phase_s; ///< the clock's error, positive: fast; NaN where there is none
};

/// Properties of a log that the reader is told or finds out.
enum class Setting : std::uint8_t {
  none,
  format,
  columns,
  unit,
  wrap,
  tau0,
  counter_rate,
  decimal_comma,
  date_order,
  channel,
  rest_angle,
  nominal_period,
  both_edges,
  flag_width,
  weather,
  weather_zone,
  pps_channel,
  clock_ppm,
  site,
};

/// An assumption made in reading a log.
struct Assumption {
  std::string text;                ///< a plain sentence
  Setting setting = Setting::none; ///< the setting that overrides it, if there is one
  std::string value{};             ///< the form of that setting, "period=N"; empty: any
};

/// One of several files that make one log.
struct LogFile {
  std::string name;
  std::uint32_t lines_before = 0; ///< in the files before it: lines are counted through all files
  std::size_t events_before = 0;  ///< as they were read, before anything was put in order
};

/// The moment from which the times of a log count.
enum class TimeOrigin : std::uint8_t {
  none,  ///< unknown, or the start of the log
  epoch, ///< 1970-01-01 UTC: dates, and counters of that kind
  mjd,   ///< 1858-11-17
};

/// Time from the beginning of the count to 1970, s; 0 for `none`.
std::int64_t seconds_before_1970(TimeOrigin origin);
/// "dates" or "times without a date".
std::string_view times_of(TimeOrigin origin);

/// A quantity of the weather that was read from files of its own and interpolated to the events.
struct JoinedWeather {
  std::string quantity; ///< temperature, pressure, humidity
  std::string source;   ///< the file, or words for several
  std::size_t readings = 0;
  double step_s = 0.0;            ///< the usual time between two readings
  double sigma = 0.0;             ///< of an interpolated value, °C, mbar or %
  std::size_t events_without = 0; ///< events without a value: in gaps, or outside the readings
};

/// The findings about a recording of sound.
struct SoundFindings {
  double rate_hz = 0.0;
  double duration_s = 0.0;
  std::int64_t drowned = 0; ///< expected beats that cannot be heard in the noise
  bool has_tocks = false;
  bool has_pps = false; ///< a second channel has the clicks of a reference, one a second
  MeanBeat tick, tock;
};

/// A comparison of the clock with the true time.
struct Reading {
  Instant time;         ///< the true time
  double error_s = 0.0; ///< of the clock, positive if it is fast
};

/// A log: events in order of time, or blocks of them where the time goes back.
struct ClockLog {
  std::string source;         ///< file name as given, or words for several
  std::vector<LogFile> files; ///< where there are several; empty for one
  LogFormat format = LogFormat::timestamps;
  std::vector<Beat> events; ///< of data on a grid, one for each value, with its cycle; the first
                            ///< three of them if only phases were wanted
  std::optional<GridData> grid;
  /// Readings at uneven times, in order of time, for which the events, at even times on the
  /// straight lines between them, stand in; else empty.
  std::vector<Reading> readings;
  EventColumns columns;
  TimeOrigin origin = TimeOrigin::none;
  std::optional<Site> site;           ///< location of the clock, if known
  std::optional<double> zone_s;       ///< of the dates, east of Greenwich: the first one named
  std::vector<JoinedWeather> weather; ///< for those of `columns` that were interpolated
  std::optional<SoundFindings> sound; ///< if it is a recording
  /// Standard deviation of the rate of the reference clock, if known. The rate of a log of any
  /// length is at least as uncertain.
  double time_base_sigma = 0.0;
  bool has_amplitude = false;
  bool directions_are_open = false; ///< the log does not say in which direction its crossings are
  std::optional<double> nominal_period_s; ///< if the log states one
  std::optional<double> flag_width_rad;   ///< the same
  std::optional<double> gravity_share;    ///< of the restoring torque, the same
  std::vector<Assumption> assumptions;
  std::vector<LineIssue> issues;

  /// The file in which a line stands, and where in it.
  [[nodiscard]] TextPlace place(std::size_t line, std::size_t column = 1) const;
};

} // namespace goingrate

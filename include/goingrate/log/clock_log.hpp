// A log as it was read: events in time, and all that was assumed or found wrong on the way.
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

/// Which way the pendulum went.
enum class Edge : std::uint8_t { up, down };

/// What an event turned out to be when the beats were numbered.
enum class BeatFlag : std::uint8_t {
  good,     ///< an upward crossing with its cycle number (or not numbered yet)
  spurious, ///< no crossing of its own: a double trigger or a false one
  down,     ///< a downward crossing, numbered with the upward crossing before it
  rival,    ///< another event that fits this cycle as well; which was the crossing cannot be told
  bounce,   ///< follows an edge so closely that it is part of it: a contact that bounces
};

/// One event of a log: as it was read and, once numbered, with its place in the going of the clock.
/// 40 bytes, so that a year of seconds fits in memory.
struct Beat {
  Instant time;
  std::int64_t cycle = 0; ///< 0 for the first good beat; of a spurious event: the beat before it
  double amplitude_rad = std::numeric_limits<double>::quiet_NaN(); ///< NaN where the log has none
  std::uint32_t line = 0;                                          ///< line of the file, from 1
  std::uint16_t segment = 0; ///< beats of one segment are numbered without doubt
  BeatFlag flag = BeatFlag::good;
  Edge edge = Edge::up;
};
static_assert(sizeof(Beat) == 40);

/// An event that is not numbered yet.
inline Beat event_at(const Instant& time, Edge edge = Edge::up, std::uint32_t line = 0,
                     double amplitude_rad = std::numeric_limits<double>::quiet_NaN()) {
  return {time, 0, amplitude_rad, line, 0, BeatFlag::good, edge};
}

/// What can be wrong with a line.
enum class IssueKind : std::uint8_t {
  unreadable,   ///< a field that is not what it should be
  missing,      ///< an empty field, too few or too many fields
  no_value,     ///< NaN, or all nines, in a place that needs a number
  out_of_range, ///< a number that cannot be meant
  binary,       ///< bytes that no text has
  truncated,    ///< a last line that was cut short
  out_of_order, ///< a time before the one before
  label_jitter, ///< a label written a step early or late
  gap,          ///< a place left empty on purpose
  header,       ///< a header in the middle, or one that does not fit the columns
  incomplete,   ///< one edge of a passage without the other
  repeated,     ///< a copy of another line
};
std::string_view name_of(IssueKind kind);

/// Something wrong with one line, or with a run of lines in the same way, and what was done about
/// it. Where more than one line in 25 is at fault (and more than 500 are), those of one kind are
/// taken together, good lines between them or not: the list must not outgrow the log.
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

/// What else the log says of its events: each empty, or one value per event, NaN where unknown.
struct EventColumns {
  std::vector<double> width_s{};       ///< how long the flag was seen
  std::vector<double> sigma_s{};       ///< standard deviation of the time
  std::vector<double> temperature_c{}; ///< degrees Celsius
  std::vector<double> pressure_mbar{};
  std::vector<double> humidity_percent{}; ///< relative

  /// Every column.
  std::array<std::vector<double>*, 5> all() {
    return {&width_s, &sigma_s, &temperature_c, &pressure_mbar, &humidity_percent};
  }
};

/// Data on a grid: no beats, but how far the clock was off at equal intervals.
struct GridData {
  double tau0_s = 1.0;         ///< the interval
  std::vector<double> phase_s; ///< the clock's error, positive: fast; NaN where there is none
};

/// What a reader is told, or finds out, about a log.
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

/// Something taken for granted.
struct Assumption {
  std::string text;                ///< a plain sentence
  Setting setting = Setting::none; ///< what says otherwise, if anything does
  std::string value{};             ///< as that setting takes it, "period=N"; empty: any
};

/// One of several files that make one log.
struct LogFile {
  std::string name;
  std::uint32_t lines_before = 0; ///< in the files before it: lines are counted through all files
  std::size_t events_before = 0;  ///< as they were read, before anything was put in order
};

/// What the times of a log count from.
enum class TimeOrigin : std::uint8_t {
  none, ///< something of the log's own
  epoch, ///< 1970-01-01 UTC: dates, and counters of that kind
  mjd,  ///< 1858-11-17
};

/// Time from the beginning of the count to 1970, s; 0 for `none`.
std::int64_t seconds_before_1970(TimeOrigin origin);
/// "dates" or "times without a date".
std::string_view times_of(TimeOrigin origin);

/// A quantity of the weather that stood in files of its own, at the events.
struct JoinedWeather {
  std::string quantity; ///< temperature, pressure, humidity
  std::string source;   ///< the file, or words for several
  std::size_t readings = 0;
  double step_s = 0.0;               ///< the usual time between two readings
  double sigma = 0.0;                ///< of an interpolated value, °C, mbar or %
  std::size_t events_without = 0; ///< in holes, and beyond the first or last reading
};

/// What a recording of sound was found to be.
struct SoundFindings {
  double rate_hz = 0.0;
  double duration_s = 0.0;
  std::int64_t drowned = 0; ///< beats expected that do not stand out of the noise
  bool has_tocks = false;
  bool has_pps = false; ///< a second channel tells the seconds
  MeanBeat tick, tock;
};

/// A log: events in order of time, or blocks of them where the time goes back.
struct ClockLog {
  std::string source;         ///< file name as given, or words for several
  std::vector<LogFile> files; ///< where there are several; empty for one
  LogFormat format = LogFormat::timestamps;
  std::vector<Beat> events; ///< of data on a grid, one for each value, with its cycle
  std::optional<GridData> grid;
  EventColumns columns;
  TimeOrigin origin = TimeOrigin::none;
  std::optional<Site> site;     ///< where the clock stands, if that is known
  std::optional<double> zone_s; ///< of the dates, east of Greenwich: the first one named
  std::vector<JoinedWeather> weather; ///< for those of `columns` that were interpolated
  std::optional<SoundFindings> sound; ///< if it is a recording
  /// Standard deviation of the rate of the clock that all times were taken with, where it is known:
  /// it is that of the log's rate as well, whatever its length.
  double time_base_sigma = 0.0;
  bool has_amplitude = false;
  bool directions_are_open = false; ///< times of crossings, and nothing says of which direction
  std::optional<double> nominal_period_s; ///< if the log states one
  std::optional<double> flag_width_rad;   ///< the same
  std::vector<Assumption> assumptions;
  std::vector<LineIssue> issues;

  /// The file in which a line stands, and where in it.
  [[nodiscard]] TextPlace place(std::size_t line, std::size_t column = 1) const;
};

} // namespace goingrate

// From a file to numbered beats: the first half of every analysis.
#pragma once

#include "goingrate/log/amplitude.hpp"
#include "goingrate/log/beats.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/log/reading.hpp"
#include "goingrate/log/weather.hpp"

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace goingrate {

/// Options of load(); what is left empty is found from the log.
struct LoadRequest {
  std::string path; ///< a file, gzip or not, a folder of files, or "-" for standard input
  std::vector<std::string> more{}; ///< files and folders of the same clock, see read_log_files()
  ReadingOptions reading{};
  WeatherRequest weather{};
  std::optional<Site> site{}; ///< of the clock; if not given, that of the log's header, if any
  bool both_edges = false;                ///< the log holds both directions without labels
  std::optional<double> dead_time_s{};    ///< of a contact that bounces; 0: none
  std::optional<double> flag_width_rad{}; ///< as seen from the pivot
  std::optional<double> sensor_offset_rad{};
  bool find_sensor_offset = false;
  /// Of the restoring torque, see clock/restoring.hpp; -10 to 1.5. None: as the log states it, or 1.
  std::optional<double> gravity_share{};
  double gap_probability = NumberingOptions{}.least_probability;
  /// A log in one file that has more events is read and numbered in parts, the first of about so
  /// many, at least 1000, the others of a quarter of that, so that all of it is never in memory;
  /// while one part is numbered, the next is read (LoadPartsTest). Logs whose events do not stand by
  /// themselves (samples of an angle, data on a grid, labels with errors, newest first), and those
  /// with weather from other files, are never divided.
  std::size_t part_events = std::numeric_limits<std::size_t>::max();
  /// Of a log in parts, no more beats are kept than this: every second, fourth, eighth ...
  std::size_t most_beats = std::numeric_limits<std::size_t>::max();
  bool phases_will_do =
      false; ///< data on a grid are accepted as they are, also if they are not a clock's, and no
             ///< beats are made from them
};

/// A log read, corrected and numbered.
struct NumberedLog {
  NumberedLog() = default;
  NumberedLog(NumberedLog&&) = default;            ///< leaves an empty log
  NumberedLog& operator=(NumberedLog&&) = default; ///< the same
  NumberedLog(const NumberedLog&) = delete;        // `good` would point into the other
  NumberedLog& operator=(const NumberedLog&) = delete;

  ClockLog log; ///< its events are in `beats`
  Beats beats;
  std::vector<Beat> chosen;   ///< owns the beats of `good` if these are not all of `beats`
  std::span<const Beat> good; ///< the good beats of the longest segment
  double nominal_period_s = 0.0;
  bool nominal_is_known = true;
  std::int64_t crossings = 0; ///< of a log in parts: good beats of the segment, those that were not
                              ///< kept too; else 0
  SensorFindings sensor;
};

/// Events of a log, numbered, as they are ready: `log.beats.beats` from number `first` to before
/// number `end`, with their columns. Those before and after are given out with another part. Cycles,
/// segments and gaps are those of the whole log.
struct LogPart {
  const NumberedLog& log;
  std::size_t first = 0, end = 0;
  std::size_t lines_expected = 0; ///< of the whole log; 0 if that is not known
};
using LogVisitor = std::function<void(const LogPart&)>;

/// Reads the log and its weather, marks bounces, labels directions, numbers the beats, settles the
/// nominal period, finds amplitudes and the sensor's offset, and numbers again if that moved the
/// times. Data on a grid are not searched for beats: their cycles follow from the grid. All
/// assumptions are listed in `log.assumptions`.
///
/// A nominal period given in the request is believed. Throws InputError if the log cannot be read,
/// ImpossibleReading if the times or periods that were read cannot be those of a clock,
/// NumericsError if no three consecutive beats could be numbered or the sensor's offset is asked
/// for and cannot be found.
///
/// `visit` gets the events as they are numbered, of a log in parts one part after the other, of
/// another log all at once. It may be called from another thread. What is thrown after it was called
/// makes void what it got.
NumberedLog load(const LoadRequest& request, const LogVisitor& visit = {});

/// The same for a text in memory; `path` names it in messages.
NumberedLog load_text(std::string_view text, const LoadRequest& request);

/// The same for events from elsewhere; `log.source` names them in messages. Of request.reading only
/// the nominal period is used, and only if the log states none. Also throws InputError for fewer
/// than three events.
NumberedLog load_events(ClockLog log, const LoadRequest& request);

/// The log's rate from end to end, with what is known of the nominal period and the time base.
RateSummary mean_rate(const NumberedLog& loaded);

/// The clock's error at equal intervals, s, positive: fast; NaN where a beat is missing. Data on a
/// grid are returned as they were read, even if they are not a clock's; of other logs, it is the
/// error in the longest segment.
struct PhaseSeries {
  std::vector<double> phase_s;
  double tau0_s = 1.0;
};
PhaseSeries phase_series(const NumberedLog& loaded);
/// The same, without a copy of data on a grid.
PhaseSeries phase_series(NumberedLog&& loaded);

} // namespace goingrate

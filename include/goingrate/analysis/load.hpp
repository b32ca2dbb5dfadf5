// From a file to numbered beats: the first half of every analysis.
#pragma once

#include "goingrate/log/amplitude.hpp"
#include "goingrate/log/beats.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/log/reading.hpp"
#include "goingrate/log/weather.hpp"

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
  SensorFindings sensor;
};

/// Reads the log and its weather, marks bounces, labels directions, numbers the beats, settles the
/// nominal period, finds amplitudes and the sensor's offset, and numbers again if that moved the
/// times. Data on a grid are not searched for beats: their cycles follow from the grid. All
/// assumptions are listed in `log.assumptions`.
///
/// A nominal period given in the request is believed. Throws InputError if the log cannot be read,
/// ImpossibleReading if the times or periods that were read cannot be those of a clock,
/// NumericsError if no three consecutive beats could be numbered or the sensor's offset is asked
/// for and cannot be found.
NumberedLog load(const LoadRequest& request);

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

} // namespace goingrate

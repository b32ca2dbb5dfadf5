// From a file to numbered beats: the first half of what is done with every log.
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

/// What load() is to do; it finds out what is left empty.
struct LoadRequest {
  std::string path; ///< a file, gzip or not, a folder of files, or "-" for standard input
  std::vector<std::string> more{}; ///< files and folders of the same clock, see read_log_files()
  ReadingOptions reading{};
  WeatherRequest weather{};
  std::optional<Site> site{}; ///< of the clock; none: what the log's header says, if it does
  bool both_edges = false;                ///< the log holds both directions without labels
  std::optional<double> dead_time_s{};    ///< of a contact that bounces; 0: none
  std::optional<double> flag_width_rad{}; ///< as seen from the pivot
  std::optional<double> sensor_offset_rad{};
  bool find_sensor_offset = false;
  double gravity_share = 1.0; ///< of the restoring torque, see clock/restoring.hpp; -10 to 1.5
  double gap_probability = NumberingOptions{}.least_probability;
  bool phases_will_do =
      false; ///< data on a grid may be those of anything: no beats are made of them
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
  std::vector<Beat> chosen;   ///< where `good` lives if it is not all of `beats`
  std::span<const Beat> good; ///< the good beats of the longest segment
  double nominal_period_s = 0.0;
  bool nominal_is_known = true;
  SensorFindings sensor;
};

/// Reads the log and its weather, marks bounces, labels directions, numbers the beats, settles the
/// nominal period, finds amplitudes and the sensor's place, and numbers again where that moved the
/// times. Data on a grid are not numbered: their places are given. What was assumed is in
/// `log.assumptions`.
///
/// A nominal period that is given is believed. Throws InputError if the log cannot be read,
/// ImpossibleReading if it was read but no clock is so far off, NumericsError if no three beats
/// could be numbered together or the sensor's place is asked for and cannot be told.
NumberedLog load(const LoadRequest& request);

/// The same for a text in memory; `path` names it in messages.
NumberedLog load_text(std::string_view text, const LoadRequest& request);

/// The same for events from elsewhere; `log.source` names them in messages. From the request's
/// reading, only the nominal period counts, and not even that if the log states one. Throws
/// InputError as well for fewer than three events.
NumberedLog load_events(ClockLog log, const LoadRequest& request);

/// The log's rate from end to end, with what is known of the nominal period and the time base.
RateSummary mean_rate(const NumberedLog& loaded);

/// The clock's error at equal intervals, s, positive: fast; NaN where a beat is missing. Data on a
/// grid are as they were read, even if they are no clock's; otherwise it is the longest segment's.
struct PhaseSeries {
  std::vector<double> phase_s;
  double tau0_s = 1.0;
};
PhaseSeries phase_series(const NumberedLog& loaded);

} // namespace goingrate

// Weather from files of its own, interpolated to the beats of a log.
#pragma once

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/reading.hpp"

#include <span>
#include <string>
#include <vector>

namespace goingrate {

/// Files with temperature, pressure or humidity, and the relation of their times to those of a log.
struct WeatherRequest {
  std::vector<std::string> files{};
  /// Time zone of dates that name none, such as +01:00; empty: that of the log's dates, or UTC.
  std::string zone{};
  double offset_s = 0.0; ///< added to all times of the weather, s
};

/// Interpolates the quantities in the files of `request` to the events of `log`. `log.columns` gets
/// the values at each event, and `log.weather` the details of the interpolation.
///
/// A file is a table with a header: a time (seconds, another unit, dates, MJD) and at least one of
/// temperature (°C, °F, K), pressure (mbar, Pa, kPa, inHg, mmHg) and humidity (%). Columns and
/// units are known by their names; a unit that is not named is settled by the size of the values.
/// Several files of one quantity are joined in order of time. Between two readings the value is
/// interpolated, unless they are more than three usual intervals of their file apart: there, and
/// outside the readings, it is NaN. The curve is a straight line, or a cubic spline if cubics
/// through four neighbours predict a reading better than lines do, as in smooth data. The standard
/// deviation of an interpolated value is taken as 2/3 of the rms by which omitted readings differ
/// from the curve. This is correct for readings with independent errors, at most 1.16 times too
/// large for a random walk, and too large for anything smoother
/// (WeatherTest.InterpolatesWithItsSigma, WeatherTest.SmoothCoursesAreFollowedByASpline).
///
/// Throws InputError if a file cannot be read, names none of the three, has dates where the log has
/// none or the other way round, or overlaps another file of the same quantity; if the log has that
/// quantity itself; if no reading lies beside the log. ArgumentError for a wrong zone, or an
/// offset beyond 1e9 s. Cost: O(events), after one pass over each file.
void join_weather(ClockLog& log, const WeatherRequest& request);

/// Density of moist air by the CIPM-2007 equation (Picard et al., Metrologia 45 (2008) 149), with
/// 400 ppm of carbon dioxide, kg/m^3; one entry for each of `temperature_c` (degrees C) and
/// `pressure_mbar`, of equal length, NaN where one of them is not known. `humidity_percent` is of
/// that length, or empty: then 50 % is taken, and the density is right to 0.5 % at 20 degrees. The
/// equation holds to 22e-6 from 15 to 27 degrees and 600 to 1100 mbar, and is smooth beyond. A
/// pendulum floats in the air and carries some along: its rate falls as the density rises.
/// (WeatherTest.DensityIsThatOfPublishedTables)
std::vector<double> air_density(std::span<const double> temperature_c,
                                std::span<const double> pressure_mbar,
                                std::span<const double> humidity_percent = {});

} // namespace goingrate

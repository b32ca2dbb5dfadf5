// Writing logs: the native format, and those of other programs.
#pragma once

#include "goingrate/log/beats.hpp"
#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/log/reading.hpp"
#include "goingrate/log/sensor.hpp"

#include <optional>
#include <span>
#include <string>

namespace goingrate {

/// The columns of a native log besides time_s, and the values in its header.
struct NativeColumns {
  bool edge = false, width = false, amplitude = false, temperature = false, pressure = false,
       humidity = false;
  int decimals = 9; ///< of times and widths
  std::optional<double> nominal_period_s{};
  std::optional<double> flag_width_rad{};
  std::optional<double> gravity_share{}; ///< of the restoring torque; none: 1
};

/// The columns that a simulated sensor of this clock fills.
NativeColumns native_columns(const SensorSettings& sensor, const ClockParameters& clock);

/// The native text of a log: '#' header lines, a row of column names (time_s, and edge, width_s,
/// amplitude_rad, temperature_c, pressure_mbar, humidity_percent where the log has them), one row
/// per event with `decimals` digits of the second. Times are those of the flag's leading edge where
/// widths are given, as the reader expects.
/// read_log gives back the same events, to the last bit if `decimals` is as large as the times'
/// digits (WritingTest.ReadsBackWhatWasWritten, WritingTest.DecimalTimesComeBackToTheBit).
std::string native_log_text(const ClockLog& log, int decimals);

/// The same, piece by piece, for logs that are written as they grow.
std::string native_log_header(const NativeColumns& columns);
void append_native_line(std::string& text, const SensedEvent& event, const NativeColumns& columns);
/// For an event as a reader returns it: if it has a width, its time is that of the flag's middle.
void append_native_line(std::string& text, const Beat& event, const EventValues& values,
                        const NativeColumns& columns);

/// Phase data as Stable32 takes them: '#' header with tau0, then the clock's error x (s, positive:
/// fast), one line per cycle, an exact 0 where a beat is missing (the first excepted).
std::string stable32_text(std::span<const Beat> beats, double nominal_period_s);

/// Timestamps as a TAPR TICC prints them: seconds with 11 decimals and the channel, chA upwards,
/// chB downwards; no date, so times are counted from the second of the first event.
std::string ticc_text(std::span<const Beat> beats);

/// A summary of keys and values with sigmas, as the .par files of pulsar timing: name, value, fit
/// flag, sigma; `fit --from` reads it.
std::string par_text(const RateSummary& summary, const Beats& beats);

} // namespace goingrate

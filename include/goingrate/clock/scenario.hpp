// A scenario: a clock, how it starts and runs, what happens to it, and the sensor that watches.
#pragma once

#include "goingrate/clock/drive.hpp"
#include "goingrate/clock/parameters.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// A change of clock parameters. It takes effect at the upward crossing that completes `at_period`
/// periods, or at the first upward crossing at or after `at_s` seconds; exactly one is set.
struct ClockEvent {
  std::optional<std::int64_t> at_period;
  std::optional<double> at_s;
  std::optional<double> nominal_period_s, epsilon, mu, phi0;

  /// The parameters after this event.
  [[nodiscard]] ClockParameters applied_to(ClockParameters clock) const;
};

/// Which crossings the simulated sensor reports.
enum class SensorEdges { up, both };

/// The simulated sensor (see log/sensor.hpp for what each does).
struct SensorSettings {
  SensorEdges edges = SensorEdges::up;
  double jitter_rms_s = 0.0;
  double resolution_s = 0.0;           ///< times are rounded to multiples of this; 0: not rounded
  double missed = 0.0;                 ///< probability that a crossing is not reported
  double spurious = 0.0;               ///< probability of a false event after a crossing
  std::optional<double> amplitude_rms; ///< noise of an amplitude column, rad; none: no column
};

/// Everything a simulation needs. Numbers are checked by check(Scenario).
struct Scenario {
  ClockParameters clock;
  std::optional<double> start_amplitude; ///< phi' at the first upward crossing; none: limit cycle
  std::optional<std::int64_t> periods;   ///< exactly one of periods and duration_s is set
  std::optional<double> duration_s;
  std::vector<ClockEvent> events; ///< in order of time
  DriveVariability drive;
  SensorSettings sensor;
};

/// Throws ArgumentError naming the first value outside its range.
void check(const Scenario& scenario);

/// Reads a scenario from TOML text; `file` names it in messages, `overrides` are "key=value" with
/// dotted keys ("clock.epsilon=1e-3"), applied over the text.
/// Throws InputError with line and column for text that is no TOML, for unknown keys, for values of
/// a wrong type and for values out of range.
Scenario parse_scenario(std::string_view text, const std::string& file,
                        const std::vector<std::string>& overrides = {});

} // namespace goingrate

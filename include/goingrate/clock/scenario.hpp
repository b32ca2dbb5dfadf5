// A scenario: a clock, its start and run, the changes during the run, and the sensor.
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
  std::optional<double> nominal_period_s{}, epsilon{}, mu{}, phi0{}, quadratic_drag{},
      dry_friction{}, impulse{}, impulse_angle{}, below{};
  std::optional<std::int64_t> every{};

  /// The parameters after this event.
  [[nodiscard]] ClockParameters applied_to(ClockParameters clock) const;
};

/// The method by which the motion is computed (see dynamics/clock_run.hpp).
enum class Method { automatic, direct, map, averaged1, averaged2, rk4 };

/// The points at which the paper's RK4 decides the sign of the torque (see dynamics/rk4.hpp).
enum class Rk4Torque { per_step, per_stage, at_switches };

/// The method and its settings.
struct MethodSettings {
  Method method = Method::automatic;
  double dt = 0.03; ///< step of rk4, scaled; 1e-6 to 1
  Rk4Torque rk4_torque = Rk4Torque::per_stage;
  /// For `automatic`: the largest error of crossing times, s. If not given, a tenth of the sensor's
  /// jitter or resolution; without either, rounding errors only.
  std::optional<double> tolerance_s;
};

/// Relative changes of the pendulum's length: the period is T0 sqrt(1 + change), renewed at every
/// upward crossing (Hoyng, sec. disc: -change/2 on the rate).
struct LengthChanges {
  double drift_per_day = 0.0; ///< -0.1 to 0.1
  /// One sine of time.
  struct Sine {
    double amplitude; ///< -0.1 to 0.1
    double period_s;  ///< > 0
  };
  std::vector<Sine> sines{};
  double temperature_coefficient = 0.0; ///< for each K from the mean; -0.01 to 0.01
  /// The relative shortening per K by a compensation, such as a jar of mercury; -0.01 to 0.01. Its
  /// temperature follows that of the air with a first-order lag.
  double compensation = 0.0;
  double compensation_lag_s = 0.0; ///< its time constant, not below 0
  /// Whether the length never changes.
  [[nodiscard]] bool none() const {
    return drift_per_day == 0.0 && sines.empty() && temperature_coefficient == 0.0 &&
           compensation == 0.0;
  }
  /// The relative change at a time, without that of the temperature.
  [[nodiscard]] double at(double time_s) const;
};

/// The temperature around the clock, which a simulated thermometer shows and the pendulum's length
/// follows.
struct Temperature {
  double mean_c = 20.0;       ///< -100 to 100
  double drift_per_day = 0.0; ///< K, -100 to 100
  /// One sine of time.
  struct Sine {
    double amplitude; ///< K, -100 to 100
    double period_s;  ///< > 0
  };
  std::vector<Sine> sines{};
  /// Degrees Celsius at a time.
  [[nodiscard]] double at(double time_s) const;
  /// The same after a first-order lag with this time constant, in the settled state.
  [[nodiscard]] double lagged_at(double time_s, double lag_s) const;
};

/// The events that the simulated sensor reports: upward crossings only; both directions; both, each
/// with the dark time of the flag; or both, with the two edges of the flag.
enum class SensorEdges { up, both, gate, four };

/// The simulated sensor (see log/sensor.hpp for the effect of each setting).
struct SensorSettings {
  SensorEdges edges = SensorEdges::up;
  double jitter_rms_s = 0.0;
  double offset_rad = 0.0;               ///< of the beam from the vertical, -1 to 1
  double flag_width_rad = 0.0;           ///< 0 to 1; 0 with one event a passage
  double resolution_s = 0.0;             ///< times are rounded to multiples of this; 0: not rounded
  double missed = 0.0;                   ///< probability that a crossing is not reported
  double spurious = 0.0;                 ///< probability of a false event after a crossing
  std::optional<double> amplitude_rms;   ///< noise of an amplitude column, rad; none: no column
  std::optional<double> temperature_rms; ///< the same of a temperature column, K
};

/// Everything a simulation needs. Numbers are checked by check(Scenario).
struct Scenario {
  ClockParameters clock;
  std::optional<double> start_amplitude; ///< phi' at the first upward crossing; none: limit cycle
  std::optional<std::int64_t> periods;   ///< exactly one of periods and duration_s is set
  std::optional<double> duration_s;
  MethodSettings method;
  std::vector<ClockEvent> events; ///< in order of time
  DriveVariability drive;
  LengthChanges length;
  Temperature temperature;
  SensorSettings sensor;

  /// The relative change of the pendulum's length at a time: its own and that of the temperature.
  [[nodiscard]] double length_change_at(double time_s) const;
};

/// Throws ArgumentError naming the first value outside its range.
void check(const Scenario& scenario);

/// The names scenarios use.
std::string_view name_of(Method method);

/// Reads a scenario from TOML text. `file` names it in messages; the path of a drive.series is
/// relative to its folder. `overrides` are "key=value" with dotted keys ("clock.epsilon=1e-3"),
/// which replace those of the text. Throws InputError with line and column for text that is not
/// TOML, for unknown keys, for values of a wrong type and for values out of range.
Scenario parse_scenario(std::string_view text, const std::string& file,
                        const std::vector<std::string>& overrides = {});

} // namespace goingrate

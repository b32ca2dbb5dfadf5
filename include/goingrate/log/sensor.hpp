// The simulated sensor: from true crossings to the events a log would hold.
#pragma once

#include "goingrate/clock/scenario.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/log/clock_log.hpp"

#include <optional>

namespace goingrate {

/// Watches the pendulum and writes down what it sees, with its own faults.
///
/// Each reported time is true time + jitter (normal), rounded to the resolution. A crossing is
/// missed with probability `missed`; after each a false event comes, with probability `spurious`,
/// at a uniformly distributed moment of the following period. Amplitudes are the turning angle that
/// belongs to the velocity at the crossing, as a flag's passage time tells it, + noise.
/// Reproducible: each kind of fault draws from its own stream of the seed.
class Sensor {
public:
  Sensor(const SensorSettings& settings, std::uint64_t seed);

  /// Sees the crossings of one period; the start of a run is a period of length 0.
  void see(const Period& period);

  /// The events seen so far, in order of time, as a native log.
  [[nodiscard]] ClockLog log(double nominal_period_s) const;

  /// Hands over, in order of time, the events that nothing seen later can precede (or all, at the
  /// end of the run): for logs that are written as they grow.
  std::vector<Beat> take(bool at_end);

private:
  void report(const TwoPart<double>& time_s, double period_s, double amplitude_rad, Edge edge);
  [[nodiscard]] Instant measured(const TwoPart<double>& time_s, double extra_s);

  SensorSettings settings_;
  RandomStream jitter_, amplitude_noise_, missed_, spurious_;
  std::vector<Beat> events_;
  double latest_crossing_s_ = 0.0;
};

/// Decimals that lose nothing of what the sensor can tell: three digits below its noise, 6 to 15.
int decimals_for(const SensorSettings& settings);

} // namespace goingrate

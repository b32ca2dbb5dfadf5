// The simulated sensor: turns true crossings into the events of a log.
#pragma once

#include "goingrate/base/random.hpp"
#include "goingrate/clock/scenario.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/log/clock_log.hpp"

#include <limits>
#include <optional>
#include <vector>

namespace goingrate {

/// One row of the log that the sensor writes.
struct SensedEvent {
  /// The part of the passage that the row reports.
  enum class Part : std::uint8_t {
    whole, ///< the passage, or its leading edge
    in,    ///< with four edges: the flag enters the beam
    out,   ///< and leaves it
  };
  Beat beat;
  double width_s = std::numeric_limits<double>::quiet_NaN(); ///< of a gate
  double temperature_c = std::numeric_limits<double>::quiet_NaN();
  Part part = Part::whole;
};

/// Reports the passages of the pendulum, with the faults of a real sensor.
///
/// The beam stands at the angle `offset`. Without a flag its crossing is the event. A flag of width
/// w makes two edges of each passage: the beam is met at offset - w/2 and left at offset + w/2 (the
/// other way round while phi falls). `up` and `both` report the leading edge, `gate` also how long
/// the beam was dark, `four` all edges. Times at angles: time_from_vertical, with the forces as
/// they act on either side of the vertical. Each edge has jitter of its own (normal) and is rounded
/// to the resolution. A passage is missed with probability `missed`, or because the swing does not
/// reach the beam; after each a false event comes, with probability `spurious`, at a uniformly
/// distributed moment of the following period. Amplitudes are the turning angle that belongs to the
/// velocity at the crossing + noise. Reproducible: each kind of fault draws from its own stream of
/// the seed.
class Sensor {
public:
  /// The sensor of a scenario whose values are in range; equal seeds give the same faults.
  Sensor(const Scenario& scenario, std::uint64_t seed);

  /// Takes the crossings of one period; the start of a run is a period of length 0.
  void see(const Period& period);

  /// Returns, in order of time, the events that no later one can precede (or all, at the end of the
  /// run): for logs that are written as they grow.
  std::vector<SensedEvent> take(bool at_end);

  /// All events, at the end of the run, as the log that a reader makes of them. Throws
  /// ArgumentError for `four`, whose edges are paired only by the reader.
  ClockLog log(double nominal_period_s);

private:
  struct Passage {
    TwoPart<double> time_s{}; // through the vertical
    double speed = 0.0;
    double period_s = 0.0;
    double nominal_s = 0.0;
    double amplitude_rad = std::numeric_limits<double>::quiet_NaN();
    Edge edge = Edge::up;
    ClockParameters before{}, after{}; // the laws on the two sides of the vertical
    double factor_before = 1.0, factor_after = 1.0;
  };

  void report(const Passage& passage);
  void report_edges(const Passage& passage, double leading_s, double trailing_s);
  void add(const Passage& passage, const Instant& time, SensedEvent::Part part, double width_s);
  [[nodiscard]] double delay(const Passage& passage, double angle) const;
  [[nodiscard]] Instant measured(const TwoPart<double>& time_s, double extra_s) const;
  double jitter();
  void finish();

  Scenario scenario_;
  const SensorSettings settings_;
  ClockParameters clock_;
  bool in_parts_;              // an action that begins in a period ends in the next
  double let_in_before_ = 0.0; // what the period before let in, as a factor
  RandomStream jitter_, amplitude_noise_, missed_, spurious_, temperature_noise_;
  std::vector<SensedEvent> events_;
  std::optional<Passage> pending_; // the last upward one: the laws after it are not known yet
  double latest_crossing_s_ = 0.0;
};

/// Decimals that keep the accuracy of the sensor: three digits below its noise, 6 to 15.
int decimals_for(const SensorSettings& settings);

} // namespace goingrate

// Direct integration of the full equation of motion over many periods.
#pragma once

#include "goingrate/base/sums.hpp"
#include "goingrate/clock/scenario.hpp"
#include "goingrate/dynamics/half_swing.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace goingrate {

/// One period, from one upward crossing to the next.
struct Period {
  std::int64_t cycle = 0;     ///< number of the upward crossing that ends it; the start is cycle 0
  TwoPart<double> time_s;     ///< when it ends, s after the start
  TwoPart<double> down_s;     ///< the downward crossing within it, s after the start
  double period_s = 0.0;      ///< its length, s
  double velocity = 0.0;      ///< phi' at its end, scaled units
  double amplitude_rad = 0.0; ///< at its end: turning angle of a free pendulum of this velocity
  double mu = 0.0;            ///< the torque that acted
  double rate_excess = 0.0;   ///< 2 pi / length - 1 (Hoyng, eq. ratemeas)
};

/// The pendulum between upward crossings; v^2 is carried in two parts.
class DirectPendulum {
public:
  /// Starts at an upward crossing with phi' = `velocity` (scaled, 0 < velocity < 2).
  explicit DirectPendulum(double velocity);

  /// What one period did, in scaled time.
  struct Step {
    SwingStatus status = SwingStatus::crossed;
    TwoPart<double> down; ///< from the start of the period to the downward crossing
    TwoPart<double> full; ///< to the next upward crossing
  };

  /// Advances one period under torque `mu`. After a status other than crossed the state is spent.
  Step advance(double epsilon, double mu, double phi0);

  [[nodiscard]] double velocity() const;
  /// Restates the velocity for a nominal period changed by the factor `ratio`.
  void rescale(double ratio);

private:
  TwoPart<double> v2_;
  bool helping_ = true; // the escapement helps the coming upward swing
};

/// Runs a scenario's clock from its start, an upward crossing (cycle 0, time 0), period by period.
///
/// Events act at upward crossings, the drive is renewed there. The limit cycle's period is kept to
/// 2e-15 of itself, so that crossing times after n steady periods are within 2e-15 n periods of
/// those of 128-bit integration (DirectTest.CrossingTimesOfPointC); constant memory.
class DirectRun {
public:
  /// Throws ArgumentError if the scenario is out of range or asks for a stationary start that does
  /// not exist.
  DirectRun(const Scenario& scenario, std::uint64_t seed);

  /// The next period; nothing when the run is complete or the clock stopped (see status).
  std::optional<Period> next();

  [[nodiscard]] double start_velocity() const { return start_velocity_; }
  /// crossed while all is well, otherwise why the clock stopped.
  [[nodiscard]] SwingStatus status() const { return status_; }
  /// The period completed last; cycle 0 before the first.
  [[nodiscard]] const Period& last() const { return now_; }

private:
  void apply_due_events();
  [[nodiscard]] bool complete() const;

  Scenario scenario_;
  std::vector<ClockEvent> pending_;
  ClockParameters clock_;
  DriveSequence drive_;
  double start_velocity_;
  DirectPendulum pendulum_;
  Period now_;
  SwingStatus status_ = SwingStatus::crossed;
};

/// The turning angle of the free pendulum that passes the vertical with phi' = v: 2 asin(v/2).
double turning_angle_of_velocity(double velocity);

} // namespace goingrate

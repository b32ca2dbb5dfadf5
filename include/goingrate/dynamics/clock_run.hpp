// A scenario's clock, period by period, by any of the methods.
#pragma once

#include "goingrate/base/errors.hpp"
#include "goingrate/base/sums.hpp"
#include "goingrate/clock/scenario.hpp"
#include "goingrate/dynamics/averaged_pendulum.hpp"
#include "goingrate/dynamics/direct.hpp"
#include "goingrate/dynamics/map.hpp"
#include "goingrate/dynamics/method_choice.hpp"
#include "goingrate/dynamics/rk4.hpp"

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

namespace goingrate {

/// One period, from one upward crossing to the next.
struct Period {
  std::int64_t cycle = 0; ///< number of the upward crossing that ends it; the start is cycle 0
  TwoPart<double> time_s; ///< when it ends, s after the start
  TwoPart<double> down_s; ///< the downward crossing within it, s after the start
  double period_s = 0.0;  ///< its length, s
  double nominal_period_s = 0.0; ///< T0 for the length in this period, s
  double velocity = 0.0;         ///< phi' at its end, scaled units (averaged1: lambda)
  double amplitude_rad = 0.0;    ///< at its end: turning angle of a free pendulum of this velocity
  double mu = 0.0;               ///< the torque (or the impulse, or a profile's factor) that acted
  double rate_excess = 0.0; ///< 2 pi / length - 1 (Hoyng, eq. ratemeas), against the nominal period
};

/// A stationary start was asked for, and the clock has no stationary swing: it would stall, or has
/// no drive or no friction.
class NoStationarySwing : public ArgumentError {
public:
  using ArgumentError::ArgumentError;
};

/// Runs a scenario's clock from its start, an upward crossing (cycle 0, time 0), period by period.
///
/// Events act at upward crossings, drive and length are renewed there. Constant memory however long
/// the run. The method is the scenario's; automatic takes that of choose_method.
class ClockRun {
public:
  /// Throws ArgumentError if the scenario is out of range or asks for a method that does not know
  /// the clock's laws, NoStationarySwing if it asks for a stationary start that does not exist.
  /// `digits` is what the method `map` makes its map with.
  ClockRun(const Scenario& scenario, std::uint64_t seed, MapDigits digits = MapDigits::wide);

  /// The next period; nothing when the run is complete or the clock stopped (see status).
  std::optional<Period> next();

  /// phi' at the start, scaled; for a stationary start, the value found.
  [[nodiscard]] double start_velocity() const { return start_velocity_; }
  /// `crossed` while the clock goes, otherwise the reason why it stopped.
  [[nodiscard]] SwingStatus status() const { return status_; }
  /// The period completed last; cycle 0 before the first.
  [[nodiscard]] const Period& last() const { return now_; }
  /// The method, and the reason for it.
  [[nodiscard]] const MethodChoice& method() const { return choice_; }
  /// Periods the map left to the direct integrator.
  [[nodiscard]] std::int64_t fallbacks() const;

private:
  using Pendulum = std::variant<DirectPendulum, MapPendulum, AveragedPendulum, Rk4Clock>;
  static Pendulum make_pendulum(const Scenario& scenario, const MethodChoice& choice,
                                double velocity, MapDigits digits);

  void apply_due_changes();
  [[nodiscard]] bool complete() const;

  Scenario scenario_;
  MethodChoice choice_;
  std::vector<ClockEvent> pending_;
  ClockParameters clock_;
  double period_now_s_; // T0 with the length as it is
  DriveSequence drive_;
  bool in_parts_ = false, let_in_ = false; // action_parts; the crossing before let it in
  double start_velocity_;
  Pendulum pendulum_;
  Period now_;
  SwingStatus status_ = SwingStatus::crossed;
};

/// The range of factors of a drive: 1 plus and minus seven standard deviations of its random parts,
/// and the full range of its sines and series.
FactorRange factor_range(const DriveVariability& drive);

/// The quantity that a factor of the drive multiplies: mu, or the impulse, or 1 for a profile.
double drive_strength(const ClockParameters& clock);

} // namespace goingrate

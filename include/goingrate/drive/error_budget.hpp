// The time error that a clock builds up under the conditions of a scenario, cause by cause, and the
// properties it would need for a smaller one.
//
// A regulated clock has errors only by what varies. With H the response of the rate to the drive in
// first order (moments.hpp), S the density of a part of the drive and t the time,
//   error^2 = int |H|^2 S sin^2(pi f t)/(pi f)^2 df.
// A sine of the rate of amplitude r and period P causes r P/(sqrt 2 pi) at the worst moment, rms
// over its phase, once t is above P/2. A rate that drifts by d a second causes d t^2/2.
#pragma once

#include "goingrate/clock/scenario.hpp"

#include <optional>
#include <string>
#include <vector>

namespace goingrate {

/// One cause of error.
struct ErrorPart {
  std::string cause; ///< in words
  std::string key;   ///< the quantity of the scenario that it is proportional to
  double size;       ///< of that quantity; for several sines, the root of the sum of squares
  double rms_s;
};

/// All causes of error.
struct ErrorBudget {
  double after_s = 0.0;
  std::vector<ErrorPart> parts;
  [[nodiscard]] double all_s() const; ///< root of the sum of squares
  /// The factor by which all sizes together (the rod with its compensation) must be multiplied for
  /// the error to be `most_s`; above 1 where it is smaller already.
  [[nodiscard]] double share_below(double most_s) const { return most_s / all_s(); }
};

/// The error that builds up in `after_s` (s, above 0). Linear in the conditions; the rms of 300
/// simulated clocks is within its scatter of it (ErrorBudgetTest.AgreesWithSimulatedClocks). In an
/// escapement that waits for the amplitude to fall to a limit (Hipp), every wait begins anew, and
/// the rate responds to the drive equally at all frequencies
/// (ErrorBudgetTest.AnEscapementThatWaitsForgetsTheImpulseBefore). Throws ArgumentError for a clock
/// that stalls or has no drive, for one that changes in an event, and for a drive given as a
/// series, which does not say what comes next.
ErrorBudget error_budget(const Scenario& scenario, double after_s);

/// The value that one quantity must have, the others unchanged, for the error to be at a limit. If
/// the error is below the limit already, the quantity may be worsened to that value.
struct Requirement {
  std::string key;             ///< "clock.epsilon", "amplitude", or a key of the scenario;
                               ///< "clock.below" in place of the amplitude where that is limited
  double present;              ///< its value now
  std::optional<double> limit; ///< nothing: this quantity alone cannot do it, or has no effect
  bool stops = false;          ///< at that limit the clock stops, or cannot exist
};

/// The limits of the friction (with the drive adjusted to keep the amplitude), of the amplitude (as
/// set by the drive alone, or the limit that it falls to) and of each condition, for an error below
/// `most_s` (s, above 0) after `after_s`. A limit is the one nearest to the present value, with a
/// relative accuracy of 1e-4 (ErrorBudgetTest.LimitsKeepTheError).
std::vector<Requirement> requirements(const Scenario& scenario, double most_s, double after_s);

} // namespace goingrate

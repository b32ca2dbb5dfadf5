// How far a clock goes wrong within some time under the conditions of a scenario, cause by cause,
// and what it would have to be to go less wrong.
//
// A clock that is regulated has no error but what varies. With H the response of the rate to the
// drive in first order (moments.hpp), S the density of a part of the drive and t the time,
//   error^2 = int |H|^2 S sin^2(pi f t)/(pi f)^2 df;
// a sine of the rate of amplitude r and period P makes r P/(sqrt 2 pi) at the worst moment, rms
// over its phase, once t is above P/2; a rate that drifts by d a second makes d t^2/2.
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
  double size;       ///< of that; for several sines, the root of their squares
  double rms_s;
};

/// All of them.
struct ErrorBudget {
  double after_s = 0.0;
  std::vector<ErrorPart> parts;
  [[nodiscard]] double all_s() const; ///< root of squares
  /// The share of its size that each part may have, all alike (the rod with its compensation), for
  /// the error to stay below `most_s`; above 1 where it does already.
  [[nodiscard]] double share_below(double most_s) const { return most_s / all_s(); }
};

/// The error that builds up in `after_s` (s, above 0). Linear in the conditions; the rms of 300
/// simulated clocks is within its scatter of it (ErrorBudgetTest.AgreesWithSimulatedClocks). For an
/// escapement that waits for its swing to fall (Hipp), whose every wait begins at the limit, the
/// rate answers to the drive alike at all frequencies
/// (ErrorBudgetTest.AnEscapementThatWaitsForgetsTheImpulseBefore). Throws ArgumentError for a clock
/// that stalls or has no drive, for one that changes in an event, and for a series of the drive,
/// which says nothing of what comes next.
ErrorBudget error_budget(const Scenario& scenario, double after_s);

/// What one quantity would have to be, the rest being as it is, for the error to stay below a
/// limit; where it does already, how far the quantity may go.
struct Requirement {
  std::string key;             ///< "clock.epsilon", "amplitude", or a key of the scenario;
                               ///< "clock.below" in place of the amplitude where that is limited
  double present;              ///< its value now
  std::optional<double> limit; ///< nothing: not by this alone, or it makes no difference
  bool stops = false;          ///< at that limit the clock stops, or cannot exist
};

/// The limits of the friction (with the drive adjusted so that the swing stays), of the amplitude
/// (as the drive alone sets it, or the limit that it falls to) and of each condition, for an error
/// below `most_s` (s, above 0) after `after_s`. Limits are those nearest to what there is, to 1e-4
/// of themselves (ErrorBudgetTest.LimitsKeepTheError).
std::vector<Requirement> requirements(const Scenario& scenario, double most_s, double after_s);

} // namespace goingrate

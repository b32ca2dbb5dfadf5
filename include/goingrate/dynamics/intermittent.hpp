// Escapements that rest: an impulse once in N periods (Synchronome, Shortt), or when the amplitude
// has fallen below a limit (Hipp).
//
// Between impulses lambda^2 falls as exp(-2 eps t) with linear friction; the energy J of one driven
// period (of phi'^2/2) lifts it by 2 J. In equilibrium over N periods, by the averaged equations
// (Hoyng, eqs. dotl4 and dotpsi4):
//   lambda_+^2 = 2 J / (1 - exp(-4 pi eps N)),  lambda_-^2 = lambda_+^2 exp(-4 pi eps N),
//   <lambda^2> = J / (2 pi eps N).
// So the mean circular error, -J/(32 pi eps N), depends on the mean power alone, and so does the
// escapement's share, since an impulse of N J, once in N periods, shifts the phase as much as N of
// J: at equal power N buys no escapement error to first order. What N adds is a saw-tooth.
#pragma once

#include "goingrate/clock/parameters.hpp"

#include <cstdint>
#include <optional>

namespace goingrate {

/// Whether the escapement begins an action at upward crossing `cycle` (0 is the first), where phi'
/// = `velocity`: in cycles that `every` divides, or if the turning angle of that velocity is less
/// than `below`. `under_way`: an earlier action has not ended; with a limit of amplitude, none
/// begins before it has.
///
/// It then acts from this crossing to the next. A profile whose push runs through the vertical
/// while phi rises (action_parts) acts as a whole from the turning point on the left that follows
/// to the one after.
bool escapement_acts(const ClockParameters& clock, std::int64_t cycle, double velocity,
                     bool under_way = false);

/// An action that an upward crossing divides into two parts: that while phi rises to the vertical,
/// and the rest. Each is given as a clock that acts in every period.
struct ActionParts {
  ClockParameters before, after;
};
/// The parts for an escapement that rests and is a profile with torque on both sides of the
/// vertical while phi rises; nullopt for others, which act between two upward crossings.
std::optional<ActionParts> action_parts(const ClockParameters& clock);

/// The least number of periods from one action to the next: 2 if an action ends in the period after
/// it began (action_parts) and prevents the next, else 1.
std::int64_t fewest_periods_between_actions(const ClockParameters& clock);

/// Whether the escapement has a limit of amplitude and rests between actions, in first order: an
/// action at the limit raises the amplitude by more than friction lowers it until the next is
/// possible. Otherwise it acts as often as possible, and the amplitude stays below the limit.
bool waits_for_amplitude(const ClockParameters& clock);

/// The clock that acts in every period, with one `periods`-th of the action of this one.
ClockParameters with_drive_divided(ClockParameters clock, double periods);

/// The energy that one driven period at amplitude lambda adds, of phi'^2/2, first order: 2 pi
/// lambda a(lambda) (moments.hpp); 4 mu phi0 for constant torque, e for a single impulse.
double energy_of_period(const ClockParameters& clock, double lambda);

/// The effect of an escapement that rests on a clock in equilibrium, first order.
struct SawTooth {
  double periods;         ///< between impulses, in the mean
  double low2, high2;     ///< lambda^2 just before and just after an impulse, rad^2
  double mean2;           ///< <lambda^2>, rad^2
  double peak_lateness_s; ///< largest lateness between two impulses by the circular error,
                          ///< s: s ((high2 - mean2) - mean2 ln(high2/mean2)) / (32 eps) T0/(2 pi)
};

/// The saw-tooth of a clock with linear friction, J being that of the mean amplitude. With `below`,
/// low2 is taken at the limit itself (impulses come up to a period after it: relative 2 pi eps),
/// and
///   periods = ln(1 + 2 J/below^2) / (4 pi eps),  mean2 = 2 J / ln(1 + 2 J/below^2).
/// nullopt for a clock whose escapement acts in every period, other friction, and where it stalls.
/// IntermittentTest.SawToothAgreesWithTheEquationOfMotion shows how it compares.
std::optional<SawTooth> saw_tooth(const ClockParameters& clock);

/// The swings of a clock whose escapement waits for the amplitude to fall: means over the orbit on
/// which they settle, by the full equation of motion, impulse after impulse.
///
/// An impulse and the periods after it map v^2, from the interval below the limit into itself. The
/// map contracts and preserves the order except at one jump. Its orbit therefore has the same mean
/// from any start; in most cases it closes after some impulses.
struct WaitingOrbit {
  double velocity = 0.0;      ///< phi' at an upward crossing that lets the escapement in
  double periods = 0.0;       ///< between impulses, in the mean
  double mean_square = 0.0;   ///< of phi' at the upward crossings
  double period_excess = 0.0; ///< T - 2 pi, scaled, in the mean
  std::int64_t impulses = 0;  ///< over which the means are taken
  /// Error bound of the rate: 1e-14 if the orbit closes; otherwise that of the inequality of Denjoy
  /// and Koksma for a finite stretch: twice the range of T over the time of the stretch.
  double rate_within = 0.0;
};

/// That orbit, for any law of friction. Within `rate_within` of the mean over other stretches
/// (WaitingOrbitTest.MeansAreThoseOfALongRun). nullopt for an escapement that does not wait, one
/// that acts whenever it can and does not reach its limit, and where the clock stalls. Some 0.1 s.
std::optional<WaitingOrbit> waiting_orbit(const ClockParameters& clock);

} // namespace goingrate

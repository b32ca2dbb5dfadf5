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

/// Whether the escapement acts in the period that begins with upward crossing `cycle` (0 is the
/// first) at phi' = `velocity`: in cycles that `every` divides, or when the turning angle of that
/// velocity is less than `below`.
bool escapement_acts(const ClockParameters& clock, std::int64_t cycle, double velocity);

/// The clock that gives in every period one `periods`-th of what this one gives in one of them.
ClockParameters with_drive_divided(ClockParameters clock, double periods);

/// The energy that one driven period at amplitude lambda adds, of phi'^2/2, first order: 2 pi
/// lambda a(lambda) (moments.hpp); 4 mu phi0 for constant torque, e for a single impulse.
double energy_of_period(const ClockParameters& clock, double lambda);

/// What an escapement that rests does to a clock in equilibrium, first order.
struct SawTooth {
  double periods;         ///< between impulses, in the mean
  double low2, high2;     ///< lambda^2 just before and just after an impulse, rad^2
  double mean2;           ///< <lambda^2>, rad^2
  double peak_lateness_s; ///< how far the circular error makes the clock late between two impulses,
                          ///< s: s ((high2 - mean2) - mean2 ln(high2/mean2)) / (32 eps) T0/(2 pi)
};

/// The saw-tooth of a clock with linear friction, J being that of the mean amplitude. With `below`,
/// low2 is taken at the limit itself (impulses come up to a period after it: relative 2 pi eps),
/// and
///   periods = ln(1 + 2 J/below^2) / (4 pi eps),  mean2 = 2 J / ln(1 + 2 J/below^2).
/// Nothing for a clock whose escapement acts in every period, other friction, and where it stalls.
/// IntermittentTest.SawToothAgreesWithTheEquationOfMotion shows how it compares.
std::optional<SawTooth> saw_tooth(const ClockParameters& clock);

} // namespace goingrate

// The effect of a turn of the rating nut on the rate.
#pragma once

namespace goingrate {

/// The nut below the bob.
struct RatingNut {
  double pitch_m = 0.0;  ///< travel of the bob in one turn, above 0
  double length_m = 0.0; ///< of the equivalent mathematical pendulum, above 0
};

/// The correction that brings the rate to zero.
struct NutTurns {
  double turns = 0.0;   ///< positive: the bob goes up, the clock gets faster
  double sigma = 0.0;   ///< of the turns, from the rate's; NaN if unknown
  double raise_m = 0.0; ///< rise of the bob
};

/// g T0^2 / 4 pi^2 (m), the length of a mathematical pendulum of small amplitude, for g = 9.81
/// m/s^2: that of mean latitudes within 0.3 %. Throws ArgumentError unless T0 > 0.
double mathematical_length(double nominal_period_s);

/// dL = -2 L r of dT/T = dL/2L, for a relative rate r (positive: fast) of size below 0.01 or so.
/// The bob counts as the whole mass: with a heavy rod the rate changes by less than stated here.
/// Throws ArgumentError unless pitch and length are above 0.
/// RatingNutTest.AClockThatLosesWantsItsBobUp has the numbers by hand.
NutTurns turns_to_zero_rate(const RatingNut& nut, double rate_excess, double sigma);

} // namespace goingrate

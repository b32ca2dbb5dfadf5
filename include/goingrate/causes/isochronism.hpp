// The dependence of a clock's rate on its amplitude.
//
// A pendulum is not isochronous: wide swings take longer (circular error), and the escapement
// advances or delays the clock by an amount that also depends on the amplitude (escapement error).
// As its drive wanders, a clock passes through a range of amplitudes and shows the sum of the two.
#pragma once

#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <optional>
#include <vector>

namespace goingrate {

/// Rate excess of the fitted clock in stationary operation, as its drive varies; first order.
struct IsochronismCurve {
  std::vector<double> amplitude_rad;
  std::vector<double> circular;   ///< -A^2/16
  std::vector<double> escapement; ///< the rest
  std::vector<double> sum;
};

/// The slope of the rate against the amplitude.
struct Isochronism {
  double amplitude_rad = 0.0; ///< the mean, at which the slope holds
  double slope = 0.0;         ///< d(rate excess)/d(amplitude), 1/rad, of slow variations
  double sigma = 0.0;
  std::optional<double> fitted_slope{}; ///< of the curve at that amplitude
  std::optional<IsochronismCurve> curve{};
};

/// The slope from the log's own variations, by generalised least squares over blocks of time.
///
/// When the drive changes the rate changes at once, and the amplitude follows with the time
/// constant of the pendulum. To first order
///   rate = (static slope) A + (lag) dA/dt + noise,
/// whatever the course of the drive; both coefficients are fitted, in noise of the rate that is
/// white, flicker and random walk. Errors of the amplitudes, estimated from the scatter of
/// neighbouring beats, inflate the sums of squares; this is subtracted. Since the relation holds to
/// first order in the friction, sigma includes half a percent of the slope.
///
/// The 95 % interval holds the slope of the simulated clock as often as it should
/// (IsochronismStudy.ShortForm, tests/studies/isochronism.txt). Limit: the slope includes any other
/// effect that varies with the amplitude, such as a temperature that thins the oil and lengthens
/// the rod. nullopt without amplitudes, with fewer than 256 beats, for a free pendulum, or if the
/// amplitude does not vary by more than its errors.
std::optional<Isochronism> isochronism(const TimingData& data, const FitSummary& fit);

} // namespace goingrate

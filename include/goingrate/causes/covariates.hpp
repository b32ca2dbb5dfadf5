// Whether the rate answers to temperature or pressure, and whether compensating for it would help.
//
// rate(t) = a + drift t + b c(t) + noise, where c is the covariate. Where a lag shows, c acts twice,
// at once and through the lag: a temperature on the rod and on what compensates it; a pressure on
// what the air carries and, by its friction, on the amplitude, which follows slowly. Readings that
// do not stand out of their errors tell nothing. b is found by generalised least squares in
// noise that is white, flicker and random walk of the rate, whose sizes are fitted too: two
// independent wanders that look alike by chance then give no significant coefficient. A coefficient
// that lowers the scatter may still increase the time error; so each half of the log is compensated
// with the coefficient found in the other half, and the time errors are compared. Limit: a
// covariate that only drifts through the log cannot be distinguished from a drift of the clock.
//
// Interpolation errors add noise, which the fit includes. So far as they are errors of the readings
// they also make the coefficient too small, by the share that they have in the variance of the
// covariate: that much is added to sigma. Gaps are bridged by lines; sigma is raised accordingly.
#pragma once

#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// The way in which a covariate acts on the rate.
enum class EffectWay : std::uint8_t {
  at_once,           ///< before what lags follows: a rod before its compensation
  direct,            ///< not through the amplitude: air that carries the bob
  through_amplitude, ///< air that brakes it: circular error and escapement
  circular_error,    ///< of the amplitude, the escapement's part being unknown
  other,             ///< all but the circular error
};

/// "at-once", "direct", "through-amplitude", "circular-error", "other".
std::string_view name_of(EffectWay way);
/// "through the amplitude" and the like.
std::string_view words_of(EffectWay way);

/// The part of an effect that comes by one way.
struct EffectPart {
  EffectWay way{};
  double coefficient = 0.0, sigma = 0.0; ///< as those of the whole
};

/// The effect of one covariate on the rate.
struct CovariateEffect {
  std::string name, unit;   ///< unit of the coefficient: 1/K, 1/mbar, m^3/kg; none for the tide
  double coefficient = 0.0; ///< b, relative rate per unit of the covariate, in `unit`
  double sigma = 0.0;       ///< of it, in `unit`, with what interpolating the covariate may add
  double lag_s = 0.0;       ///< time constant of the lag, s; 0 if the log shows none
  double without_s = 0.0;   ///< rms time error over the other half, its mean rate removed, s
  double with_s = 0.0;      ///< the same with the coefficient, s
  /// The standard deviation of a value between two readings, in the unit of the covariate (K, mbar,
  /// kg/m^3); 0 if there is a reading at each beat.
  double interpolation_sigma = 0.0;
  double step_s = 0.0;      ///< between two readings, s; 0 if there is one at each beat
  double known_share = 1.0; ///< of the log, 0 to 1; the rest is left out
  /// The ways, where the log tells them apart: `at_once`, where the rest comes after `lag_s` and the
  /// whole holds then; and two more, through the amplitude and otherwise.
  std::vector<EffectPart> parts{};
  /// The coefficient of the amplitude, rad per unit of the covariate; NaN where the log has none.
  double amplitude = std::numeric_limits<double>::quiet_NaN(), amplitude_sigma = amplitude;
  /// The part that comes by a way; none where it is not told.
  [[nodiscard]] const EffectPart* part(EffectWay way) const;
  /// Whether the coefficient, or that of the part at once, is beyond three sigma.
  [[nodiscard]] bool significant() const;
  /// Whether compensating lowers the time error over the half that the coefficient was not fitted
  /// to.
  [[nodiscard]] bool helps() const { return significant() && with_s < without_s; }
};

/// The effects of the data's terms other than "drift". Terms that do not vary, or only along a
/// straight line, are left out; a log of fewer than 256 beats gives none.
/// CovariateTest.FindsACoefficientWithItsSigma,
/// CovariateTest.AWanderSharedByChanceIsNotTakenForAnAnswer. Cost: O(N).
std::vector<CovariateEffect> covariate_effects(const TimingData& data);

/// Tells what each covariate (but the tide) does to the rate through the amplitude from what it
/// does otherwise, where the log has amplitudes; else nothing changes.
///
/// Denser air carries more of the bob, which slows the clock, and brakes it, which lowers the
/// amplitude and moves the rate by the circular error and the escapement error. The amplitude's own
/// answer is found as the rate's is; times d(rate)/d(amplitude) under a change of friction at
/// constant drive it is the second way, and the rest is the first. That slope is the fitted
/// clock's, or, where the fit leaves the escapement undetermined, - s A/8 of the circular error
/// alone. The intervals of both ways cover in simulated clocks (tests/studies/conditions.txt;
/// BarometersTwoWays.AreToldApart).
void tell_ways(const TimingData& data, const FitSummary& fit,
               std::vector<CovariateEffect>& effects);

/// What one quantity does to the rate besides the others.
struct WeatherPart {
  std::string name, unit;
  double coefficient = 0.0, sigma = 0.0; ///< relative rate per unit
};

/// The coefficients of temperature, pressure and humidity, as many as the data have, found together
/// (without lags), so that none stands for another. Nothing for data that have none, or with fewer
/// than 256 beats. (CovariateTest.PartsAreFoundTogether)
std::vector<WeatherPart> weather_parts(const TimingData& data);

/// A sentence about one covariate.
std::string covariate_text(const CovariateEffect& effect);

} // namespace goingrate

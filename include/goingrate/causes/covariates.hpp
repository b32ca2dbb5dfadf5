// Whether the rate responds to temperature or pressure, and whether compensation would help.
//
// rate(t) = a + drift t + b c(t) + noise, where c is the covariate. A response that lags has two
// parts, immediate and lagged: temperature acts on the rod and, later, on its compensation;
// pressure acts by buoyancy and, by friction, on the amplitude, which follows slowly. Readings that
// hardly exceed their own errors give no coefficient. b is found by generalised least squares in
// white noise, flicker and random walk of the rate, whose sizes are fitted too, so that two
// independent wanders that look alike by chance give no significant coefficient. A coefficient that
// lowers the scatter may still increase the time error. Therefore each half of the log is
// compensated with the coefficient found in the other half, and the time errors are compared.
// Limit: a covariate that only drifts through the log cannot be distinguished from a drift of the
// clock.
//
// Interpolation errors add noise, which the fit includes. The part that comes from errors of the
// readings also makes the coefficient too small, by their share in the variance of the covariate;
// this is added to sigma. Gaps are bridged by straight lines, and sigma is raised accordingly.
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
  at_once,           ///< immediate, where another part lags: a rod before its compensation
  direct,            ///< not through the amplitude: the buoyancy of the bob
  through_amplitude, ///< friction of the air: circular and escapement error
  circular_error,    ///< that of the amplitude alone, where the escapement error is unknown
  other,             ///< everything but the circular error
};

/// "at-once", "direct", "through-amplitude", "circular-error", "other".
std::string_view name_of(EffectWay way);
/// "through the amplitude" and the like.
std::string_view words_of(EffectWay way);

/// The part of an effect that acts in one way.
struct EffectPart {
  EffectWay way{};
  double coefficient = 0.0, sigma = 0.0; ///< in the units of the whole effect
};

/// The effect of one covariate on the rate.
struct CovariateEffect {
  std::string name, unit;   ///< unit of the coefficient: 1/K, 1/mbar, m^3/kg; none for the tide
  double coefficient = 0.0; ///< b, relative rate per unit of the covariate, in `unit`
  double sigma = 0.0;       ///< of b, in `unit`, including errors of interpolation
  double lag_s = 0.0;       ///< time constant of the lag, s; 0 if the log shows none
  double without_s = 0.0;   ///< rms time error over the other half, its mean rate removed, s
  double with_s = 0.0;      ///< the same with the coefficient, s
  /// The standard deviation of a value between two readings, in the unit of the covariate (K, mbar,
  /// kg/m^3); 0 if there is a reading at each beat.
  double interpolation_sigma = 0.0;
  double step_s = 0.0;      ///< between two readings, s; 0 if there is one at each beat
  double known_share = 1.0; ///< of the log, 0 to 1; the rest is left out
  /// The parts, where the log tells them apart: `at_once`, if the rest follows with the lag `lag_s`
  /// (`coefficient` is the whole, once it has followed), and two more, through the amplitude and
  /// otherwise.
  std::vector<EffectPart> parts{};
  /// The coefficient of the amplitude, rad per unit of the covariate; NaN where the log has none.
  double amplitude = std::numeric_limits<double>::quiet_NaN(), amplitude_sigma = amplitude;
  /// The part that acts in a way; null where the log does not tell it apart.
  [[nodiscard]] const EffectPart* part(EffectWay way) const;
  /// Whether the coefficient, or that of the immediate part, exceeds three sigma.
  [[nodiscard]] bool significant() const;
  /// Whether compensation lowers the time error in the half of the log that the coefficient was not
  /// fitted to.
  [[nodiscard]] bool helps() const { return significant() && with_s < without_s; }
};

/// The effects of the data's terms other than "drift". Terms that do not vary, or only along a
/// straight line, are left out; a log of fewer than 256 beats gives none.
/// CovariateTest.FindsACoefficientWithItsSigma,
/// CovariateTest.AWanderSharedByChanceIsNotTakenForAnAnswer. Cost: O(N).
std::vector<CovariateEffect> covariate_effects(const TimingData& data);

/// Separates the effect of each covariate (but the tide) through the amplitude from the rest, and
/// adds both to `parts`. Does nothing for a log without amplitudes.
///
/// Denser air carries more of the bob, which slows the clock. It also brakes the bob, which lowers
/// the amplitude and changes the rate by the circular error and the escapement error. The response
/// of the amplitude is found like that of the rate. The part through the amplitude is that response
/// times d(rate)/d(amplitude) under a change of friction at constant drive; the rest is the direct
/// part. The slope is that of the fitted clock or, if the fit leaves the escapement undetermined,
/// -s A/8 of the circular error alone. The intervals of both parts hold the true values of
/// simulated clocks as often as they should (tests/studies/conditions.txt;
/// BarometersTwoWays.AreToldApart).
void tell_ways(const TimingData& data, const FitSummary& fit,
               std::vector<CovariateEffect>& effects);

/// The effect of one quantity on the rate, the others held fixed.
struct WeatherPart {
  std::string name, unit;
  double coefficient = 0.0, sigma = 0.0; ///< relative rate per unit
};

/// The coefficients of temperature, pressure and humidity, as far as the data have them, found
/// together (without lags), so that none stands for another. Empty for data without any or with
/// fewer than 256 beats. (CovariateTest.PartsAreFoundTogether)
std::vector<WeatherPart> weather_parts(const TimingData& data);

/// A sentence about one covariate.
std::string covariate_text(const CovariateEffect& effect);

} // namespace goingrate

// From samples of a swinging angle (video, phone, encoder) to crossings of the vertical.
#pragma once

#include "goingrate/base/instant.hpp"
#include "goingrate/log/clock_log.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace goingrate {

/// One sample.
struct AngleSample {
  Instant time;
  double angle = 0.0;     ///< rad; for crossings alone any unit will do
  std::uint32_t line = 0; ///< of the file
};

/// A passage through the rest angle.
struct SampledCrossing {
  Instant time;
  double sigma_s = 0.0; ///< standard deviation of the time
  /// Turning angle of the swing here, in the samples' unit; NaN at the ends, where half is missing.
  double amplitude = 0.0;
  Edge edge = Edge::up;   ///< up: the angle rises
  std::uint32_t line = 0; ///< of the sample before it
};

/// What samples of an angle hold.
struct SampledSwings {
  std::vector<SampledCrossing> crossings;
  double rest_angle = 0.0; ///< where the pendulum hangs
  double period_s = 0.0;   ///< median time between crossings of one direction
  double noise = 0.0;      ///< standard deviation of a sample about the local fits
  double samples_per_period = 0.0;
  std::size_t unfitted = 0; ///< passages with too few samples around them
};

/// With fewer samples per period than this nothing is found: with two the swing is not determined,
/// and with a few more it is by their noise alone.
inline constexpr double fewest_samples_per_period = 2.5;

/// Finds the crossings of `samples` (in order of time).
///
/// A passage is a change of sign that goes beyond a fifth of the swing on both sides, so that noise
/// about the vertical is not counted. To the samples within a quarter of a period of each a swing
/// is fitted by least squares: a sine of its own amplitude, phase and middle, with the period and
/// the fading that its neighbours show. For samples in rad, the overtones of a pendulum's swing are
/// taken into account, so that the amplitude is the turning angle. The crossing is where that swing
/// is at the rest angle; this, if not given, is the median of the middles. No two passages share a
/// sample, so the errors of their times and amplitudes are independent; its sigma is that of the
/// crossing under the pooled noise of all fits. With fewer than 10 samples per period the samples
/// lie within 2.5/samples periods, at most 0.6, and the middle of a swing is the rest angle: then
/// neighbours share samples, and what is fitted to all of them is known up to half as well again as
/// it says.
///
/// Sigma holds as a coverage and the error is without bias, whichever the friction:
/// AngleSamplesTest.SigmasCover, AngleSamplesTest.AFewSamplesAPeriodWillDo,
/// AngleSamplesTest.AmplitudesAreWithoutBias. Cost O(N). No crossing is found with fewer than three
/// swings; samples fewer than `fewest_samples_per_period` give their number alone.
SampledSwings crossings_of_samples(std::span<const AngleSample> samples,
                                   std::optional<double> rest_angle = {}, bool in_rad = true);

} // namespace goingrate

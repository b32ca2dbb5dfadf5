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
  double sigma_s = 0.0;   ///< standard deviation of the time
  double amplitude = 0.0; ///< mean of the turning angles before and after, in the samples' unit
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

/// With fewer samples a period than this nothing is found: with two the swing is not determined,
/// and with a few more it is by their noise alone.
inline constexpr double fewest_samples_per_period = 2.5;

/// Finds the crossings of `samples` (in order of time).
///
/// A passage is a change of sign that goes beyond a fifth of the swing on both sides, so that noise
/// about the vertical is not counted. Around each, a cubic is fitted by least squares to the
/// samples within an eighth of a period (a sixth if those are fewer than six); its root is the
/// crossing. The fifth-order term it leaves out is odd about the crossing and shifts nothing. The
/// sigma is that of the root under the pooled noise of all fits. The turning angles are those of
/// parabolas through the samples within a twelfth of a period of each extreme. The rest angle, if
/// not given, is the median of the middles between turning angles.
///
/// Where there are fewer than 32 samples a period, a fading sine of the mean period is fitted
/// instead to the samples within 0.6 periods of each crossing; its root, its amplitude and its
/// middle are those of the swing. Of samples in rad the third harmonic of a pendulum's swing is
/// taken into account, so that the amplitudes are turning angles to 2e-4 at 1 rad. An amplitude
/// takes a turn on either side. Sigma holds as a coverage and the error is without bias:
/// AngleSamplesTest.SigmasCover, AngleSamplesTest.AFewSamplesAPeriodWillDo. Cost O(N). No crossing
/// is found with fewer than three swings; samples fewer than `fewest_samples_per_period` give their
/// number alone.
SampledSwings crossings_of_samples(std::span<const AngleSample> samples,
                                   std::optional<double> rest_angle = {}, bool in_rad = true);

} // namespace goingrate

// Finds crossings of the vertical in samples of a swinging angle (video, phone, encoder).
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

/// The crossings that samples of an angle contain.
struct SampledSwings {
  std::vector<SampledCrossing> crossings;
  double rest_angle = 0.0; ///< where the pendulum hangs
  double period_s = 0.0;   ///< median time between crossings of one direction
  double noise = 0.0;      ///< standard deviation of a sample about the local fits
  double samples_per_period = 0.0;
  std::size_t unfitted = 0; ///< passages with too few samples around them
};

/// With fewer samples per period than this nothing is found: with two the swing is not determined,
/// and with a few more it would follow their noise.
inline constexpr double fewest_samples_per_period = 2.5;

/// Finds the crossings of `samples` (in order of time).
///
/// A passage is a change of sign that goes beyond a fifth of the swing on both sides, so that noise
/// about the vertical is not counted. A swing is fitted by least squares to the samples within a
/// quarter of a period of each passage: a sine with its own amplitude, phase and middle, and with
/// the period and the decay of its neighbours. For samples in rad, the overtones of a pendulum's
/// swing are taken into account, so that the amplitude is the turning angle. The crossing is the
/// time at which that swing is at the rest angle, which, if not given, is the median of the
/// middles. No two passages share a sample, so the errors of their times and amplitudes are
/// independent; the sigma of a crossing comes from the pooled noise of all fits. With fewer than 10
/// samples per period the samples lie within 2.5/samples periods, at most 0.6, and the middle of
/// each swing is the rest angle. Neighbours then share samples, and the errors of a fit to all
/// crossings can be up to half as large again as their sigmas imply.
///
/// The intervals cover as they should and the errors are without bias, whatever the friction:
/// AngleSamplesTest.SigmasCover, AngleSamplesTest.AFewSamplesAPeriodWillDo,
/// AngleSamplesTest.AmplitudesAreWithoutBias. Cost O(N). No crossing is found with fewer than three
/// swings; with fewer samples than `fewest_samples_per_period` only their number is returned.
SampledSwings crossings_of_samples(std::span<const AngleSample> samples,
                                   std::optional<double> rest_angle = {}, bool in_rad = true);

} // namespace goingrate

// A first estimate of a log's noise, from its times and amplitudes alone.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <span>

namespace goingrate::timing_model {

/// The lower bound of the jitter, s: the larger of the rounding of doubles in a log of this length
/// and half the rms error that the steps of its times cause. A smaller jitter means nothing.
double least_jitter(const TimingData& data);

/// The rms of the jitter, of the step per cycle of a random walk of the times, and of the error of
/// the amplitudes.
struct NoiseGuess {
  double jitter_s = 0.0, walk_s = 0.0, amplitude_rad = 0.0;
  bool walks = false; ///< there is a walk: jitter alone would not vary as much over eight beats
};
/// The noise as third differences of the data show it.
NoiseGuess guess_noise(const TimingData& data);

/// Whether the residuals of a fit to these times walk, as noise of the drive makes them, over
/// however many beats: what they depart from jitter by is not smooth.
bool walks(const TimingData& data, std::span<const double> residual);

/// Cycles between neighbouring beats, the median of the first thousand: 1 or, with both directions,
/// 1/2; more in a log that was thinned.
double usual_spacing(const TimingData& data);

} // namespace goingrate::timing_model

// A first idea of a log's noise, from its times and amplitudes alone.
#pragma once

#include "goingrate/fit/timing_data.hpp"

namespace goingrate::timing_model {

/// The smallest jitter that means anything for these data: what rounding does to a long log, in its
/// doubles and in the steps of its times.
double least_jitter(const TimingData& data);

/// A first idea of the noise, from the data alone.
struct NoiseGuess {
  double jitter_s = 0.0, walk_s = 0.0, amplitude_rad = 0.0;
  bool walks = false; ///< the walk stands out of what jitter alone would show
};
NoiseGuess guess_noise(const TimingData& data);

} // namespace goingrate::timing_model

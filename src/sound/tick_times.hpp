// Finds the time at which each beat began, to a fraction of a sample.
#pragma once

#include "loudness.hpp"
#include "tick_track.hpp"

#include "goingrate/sound/ticks.hpp"

#include <functional>

namespace goingrate {

/// Learns the power of the mean tick and tock in bins of some 60 us from up to 600 of each, and
/// fits both to every beat that stands out: its place by the logarithms of the power, least squares
/// weighted by their scatter, which is that of chi-square in the noise and of the beats themselves
/// in the sound. Sigma is from the curvature, widened where the fit is bad.
TickTrain time_ticks(Whitening& sound, const Loudness& loudness, const TickTrack& track,
                     double rate_hz, const std::function<void(double)>& progress);

} // namespace goingrate

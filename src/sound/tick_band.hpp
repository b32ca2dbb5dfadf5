// The band in which a clock is heard best.
#pragma once

#include "loudness.hpp"
#include "tick_track.hpp"

#include <vector>

namespace goingrate {

/// A symmetric filter, of an odd number of taps, whose power response is S/(N (N + S)): S and N are
/// the mean spectra of the beats of a track and of the sound between them. By the power after this
/// filter, beats that are Gaussian noise with that spectrum are told from the background better
/// than after any other filter.
std::vector<float> band_of_ticks(Whitening& sound, const Loudness& loudness,
                                 const TickTrack& track);

/// A filter of that form that passes an octave on either side of a frequency.
std::vector<float> band_around(double frequency_hz, double rate_hz);

} // namespace goingrate

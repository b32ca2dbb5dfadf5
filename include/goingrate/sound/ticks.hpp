// Ticks and tocks in a recording of a clock: the times of their beginnings, with uncertainties.
//
// Model: the recording is whitened by linear prediction, so that the background is noise of slowly
// varying power f(t). A tick adds power a g(t - t_i), where g is the mean beat, learnt from the
// recording for ticks and tocks separately. Power in short bins then scatters about f + a g as
// chi-square, and by the variation of the beats themselves. The time t_i is that of the best fit to
// the logarithm of the power.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace goingrate {

/// One channel of a recording.
struct SoundSamples {
  double rate_hz = 0.0;
  std::int64_t count = 0;
  /// Fills `to` with the samples from `first` on; those outside of the recording are 0.
  std::function<void(std::int64_t first, std::span<float> to)> read;
};

/// The sound of one tick or tock.
struct Tick {
  double at = 0.0;    ///< where it begins, in samples from the beginning of the recording
  double sigma = 0.0; ///< standard deviation of that
  bool is_tock = false;
};

/// The mean sound of a tick or of a tock: its power over that of the background.
struct MeanBeat {
  double begin_s = 0.0; ///< of the first value, from where the beat begins
  double step_s = 0.0;  ///< between values
  /// Time in which the sound rises from where it first stands out to half of its first click: its
  /// beginning is known only to this. It is the same for all beats of a kind, so it enters the
  /// difference of tick and tock but no rate.
  double rise_s = 0.0;
  std::vector<double> power; ///< over that of the background in the middle of the recording
};

/// The beats found in a recording.
struct TickTrain {
  std::vector<Tick> ticks;  ///< in order of time
  double period = 0.0;      ///< approximate period of the oscillation (tick and tock), in samples
  bool has_tocks = false;   ///< false: one sound a period
  bool is_even = false;     ///< the sounds come at equal intervals: each may be a period as well
  std::int64_t drowned = 0; ///< expected beats that cannot be heard in the noise
  MeanBeat tick, tock;
};

/// Finds the beats of one clock. The period of the oscillation, 0.15 to 3.6 s, is that of the
/// loudness; a nominal period is believed to 3 %. Where beats come at equal intervals every one is
/// half a period, tick or tock. They are followed through noise and gaps by the most likely
/// sequence of phases (Viterbi's algorithm), so that louder sounds are not mistaken for them.
///
/// Returns no ticks if nothing periodic can be heard. Accuracy and coverage of sigma:
/// TicksTest.TimesAreRightWithinTheirSigma; noises, rates and faults: tests/studies/sound.txt. Cost
/// O(N), some 30 ns per sample; memory 13 bytes per millisecond. The samples must be finite. Throws
/// ArgumentError for a sampling rate outside 4 kHz to 400 kHz, or a nominal period outside 0.15
/// to 3.6 s.
TickTrain find_ticks(const SoundSamples& samples, std::optional<double> nominal_period_s = {},
                     const std::function<void(double)>& progress = nullptr);

} // namespace goingrate

// Whitening by linear prediction: keeps the part of each sample that the samples before it do not
// predict.
#pragma once

#include "goingrate/sound/ticks.hpp"

#include <span>
#include <vector>

namespace goingrate {

/// A prediction-error filter for a whole recording.
class Whitening {
public:
  /// Learns the filter (autocorrelation method, Levinson's recursion) from blocks all over the
  /// recording, each with the same weight, however loud.
  explicit Whitening(const SoundSamples& samples);

  /// Appends a symmetric filter of an odd number of taps, in place of an earlier one.
  void follow_by(std::span<const float> symmetric);

  /// Fills `to` with whitened samples from `first` on.
  void read(std::int64_t first, std::span<float> to);

private:
  const SoundSamples& samples_;
  std::vector<float> prediction_; // weights of the sample itself, of the one before it, ...
  std::vector<float> filter_;     // the whole filter, from `ahead_` samples later on
  std::size_t ahead_ = 0;
  std::vector<float> raw_;
};

} // namespace goingrate

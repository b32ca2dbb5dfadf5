// Pulses of a reference clock, one per second, in a channel of a recording.
#pragma once

#include "goingrate/sound/ticks.hpp"

#include <vector>

namespace goingrate {

/// The seconds marked by the pulses in a channel.
class SecondPulses {
public:
  /// Finds the leading edges: the steepest rises or falls, whichever are steeper, where they reach
  /// half of the median size of one per second, to a fraction of a sample. Pulses that are missing
  /// are counted over; those not a whole second from the others are left out.
  explicit SecondPulses(const SoundSamples& samples);

  /// The number of pulses found; fewer than three are of no use.
  [[nodiscard]] std::size_t count() const { return places_.size(); }

  /// Seconds from the first pulse to a place (in samples): by the straight line through the eight
  /// pulses around it.
  [[nodiscard]] double time_at(double place) const;
  /// Whether there are pulses within two seconds before and after a place.
  [[nodiscard]] bool covers(double place) const;

  /// The mean sampling rate, Hz.
  [[nodiscard]] double rate_hz() const;
  /// Relative standard deviation of the mean sampling rate, from the scatter of pulses at both
  /// ends.
  [[nodiscard]] double rate_sigma() const;
  /// Standard deviation of a time, s, between pulses on both sides.
  [[nodiscard]] double time_sigma_s() const;

private:
  [[nodiscard]] double scatter() const;
  void count_from(const std::vector<double>& places, std::size_t first);

  double nominal_hz_;
  std::vector<double> places_;  // in samples
  std::vector<double> seconds_; // whole
};

} // namespace goingrate

// What a log shows of pushes cycle by cycle, and pushes that may explain it. Private to the fit
// room.
#pragma once

#include "push_shapes.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace goingrate::push_shapes {

constexpr double least_gain = 18.0;              // 2 log L, after the price
constexpr std::size_t searched_cycles = 200'000; // of a log at most: enough to see a push

/// The known data, cycle by cycle.
struct Sight {
  Grid late, amplitude;                           // the second is empty if the log has none
  double late_noise = 0.0, amplitude_noise = 0.0; // of one value
  [[nodiscard]] bool has_swing() const { return !amplitude.empty(); }
  /// Mean squares of times and amplitudes, in units of their noise.
  [[nodiscard]] double in_noise(double late_squares, double swing_squares) const;
};

/// The first `most` cycles.
Sight seen(const TimingData& data, std::size_t most);

/// Possible pushes, and how much of the squares of times and amplitudes they explain, in units of
/// their noise, per cycle on average, which decides between one number of swings and another.
struct Candidate {
  ImpulseCycle pushes;
  double squares = 0.0;
};

/// Pushes each of which has a place of its own: their shapes by least squares, without the slow
/// part. nullopt if there are too few whole intervals. They count as irregular.
std::optional<Candidate> irregular_candidate(const Sight& sight, std::vector<double> pushes,
                                             double periods, double price);

/// The pushes in words of the public type; they count as regular.
ImpulseCycle described(const std::vector<double>& pushes, double periods, const Coefficients& late,
                       const std::optional<Coefficients>& swing, double price);

} // namespace goingrate::push_shapes

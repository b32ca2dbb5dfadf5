// The components of a clock's rate, by the likelihood of its periodogram. Private to the drive
// room.
//
// The rate of period n is that of a white drive and a slow one through the clock's response H, and
// the sensor's jitter. With T the period, d, s, j the rms of fast drive, slow drive and jitter, and
// r = exp(-T/tau) the slow drive's memory from period to period, its one-sided density is
//   S(f) = |H|^2 2 T [d^2 + s^2 (1 - r^2)/(1 - 2 r cos(2 pi f T) + r^2)] + 8 (j^2/T) sin^2(pi f T).
// Whittle's likelihood of the periodogram I is -log L = sum over f of log E + I/E, where E is what
// the model expects the periodogram to be: S smeared by the finite length (A. M. Sykulski et al.,
// Biometrika 106 (2019) 251), which accounts for the leakage of a steep spectrum. Neighbouring
// frequencies are combined where S is smooth.
#pragma once

#include "goingrate/dynamics/stationary.hpp"

#include <array>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// Sizes of the components.
struct RateComponents {
  double fast2 = 0.0;    ///< d^2
  double slow2 = 0.0;    ///< s^2
  double jitter2 = 0.0;  ///< j^2, s^2
  double memory_s = 0.0; ///< tau

  /// Densities at a frequency, 1/Hz.
  [[nodiscard]] double fast_density(double hz, double period_s,
                                    const DriveResponse& response) const;
  [[nodiscard]] double slow_density(double hz, double period_s,
                                    const DriveResponse& response) const;
  [[nodiscard]] double jitter_density(double hz, double period_s) const;
};

enum class Component { fast, slow, jitter };
double variance_of(const RateComponents& components, Component which);

/// The likelihood of one series and its maximum.
class ComponentFit {
public:
  /// `rates`: one per period, finite, 64 or more; the mean is subtracted.
  ComponentFit(std::span<const double> rates, double period_s, const DriveResponse& response);

  [[nodiscard]] const RateComponents& best() const { return best_; }
  /// The best fit with insignificant components set to 0, except `which`. A size that cannot be
  /// negative is too large on average if the true one is 0, at the expense of the other sizes.
  [[nodiscard]] RateComponents best_for(Component which) const;
  /// The gain in log L above which a slow drive is accepted; noise alone reaches it in one log of
  /// eight.
  static constexpr double least_evidence = 2.0;

  /// The increase of log L by a slow drive.
  [[nodiscard]] double gain_of_slow() const { return without_slow_ - best_value_; }

  /// The ends of the 68 % profile interval of one variance (d^2, s^2 or j^2), where -log L,
  /// minimised over the other components, is 1/2 above its minimum; each with the other components
  /// that are best there. The low end is 0 if -log L does not rise that far; the high end is
  /// infinite if nothing bounds it.
  [[nodiscard]] std::array<RateComponents, 2> interval68(Component which) const;

private:
  struct Bin {
    double frequency_hz, count, power;
    double response2; // |H|^2
    double smearing;  // E over S
    double sine2;     // sin^2(pi f T)
  };
  using Shapes = std::array<double, 3>; // E of each variance of 1
  // -log L at its lowest with tau held, and one of the variances if it is given.
  struct Held {
    int which = -1;
    double variance = 0.0;
    unsigned absent = 0; // a bit for each variance that is 0
  };
  struct Place {
    double value = 0.0;
    RateComponents at;
  };

  void gather(std::span<const double> rates);
  void smear();
  [[nodiscard]] Place lowest(double memory_s, const Held& held) const;
  [[nodiscard]] Place lowest_over_memory(const Held& held) const;
  [[nodiscard]] std::vector<Shapes> shapes(double memory_s) const; // one for each bin
  [[nodiscard]] double value_at(const RateComponents& at, const std::vector<Shapes>& shapes) const;

  double period_s_;
  DriveResponse response_;
  std::size_t size_;
  std::vector<Bin> bins_;
  std::array<double, 3> all_{}; // each variance if it alone made all of the power
  RateComponents best_;
  double best_value_ = 0.0, without_slow_ = 0.0;
};

} // namespace goingrate::timing_model

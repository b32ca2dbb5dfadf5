// Fits the mean beat to one beat.
#pragma once

#include "beat_powers.hpp"

#include <span>
#include <vector>

namespace goingrate {

/// The mean of ticks, or of tocks: power relative to their own strength, its relative variance from
/// beat to beat, and its correlation between bins by their distance.
struct BeatKind {
  std::vector<double> shape;
  std::vector<double> variance;
  std::vector<double> correlation{1.0};
  double rise = 0.0;  // bins
  double after = 0.0; // bins that it begins after the rough places
};

/// The place in its snippet at which a beat begins.
struct BeatPlace {
  double bin = 0.0, sigma = 0.0;
  double strength = 0.0;
  double quality = 0.0; // log-likelihood, but for a constant
  bool inside = false;
};

/// Fits the mean beat to a single one.
class BeatFit {
public:
  BeatFit(const BeatGrid& grid, const BeatKind& kind) : grid_(grid), kind_(kind) {}

  BeatPlace operator()(const BeatSnippet& snippet);

private:
  // In units of the background; at least the smallest strength that can be recognised.
  [[nodiscard]] double strength_at(const BeatSnippet& snippet, std::ptrdiff_t shift) const;

  // A hundredth of the strength is added, because the foot of a loud beat changes by orders of
  // magnitude within a bin and would otherwise dominate.
  static constexpr double foot_share = 0.01;

  void take_logs(const BeatSnippet& snippet, double strength);

  // Expected logarithms and the inverse of their variances.
  void predict(double strength);

  [[nodiscard]] double misfit(std::ptrdiff_t shift) const;

  [[nodiscard]] std::ptrdiff_t best_shift();

  // Between bins by the parabola through three misfits.
  [[nodiscard]] BeatPlace placed(std::ptrdiff_t best, double strength) const;

  // The log-likelihood of all powers of the snippet, up to a constant; those around the beat are
  // background.
  [[nodiscard]] double log_likelihood(std::ptrdiff_t best, double strength) const;

  // The distance of other places from the best, weighted by their likelihood: in noise there are
  // several.
  [[nodiscard]] double spread(std::ptrdiff_t best) const;

  // The standard deviation of the place, in bins: the estimate is a sum of the logarithms' errors,
  // each times its weight and slope.
  [[nodiscard]] double sigma() const;

  static double correlated(std::span<const double> terms, std::span<const double> correlation);

  const BeatGrid& grid_;
  const BeatKind& kind_;
  std::vector<float> logs_, misfits_;
  std::vector<double> expected_, weights_, noise_, own_;
};

} // namespace goingrate

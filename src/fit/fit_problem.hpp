// One least-squares problem: a model, its data, noise and corrections. Private to the fit room.
#pragma once

#include "goingrate/fit/clock_fit.hpp"
#include "timing_model.hpp"

#include <Eigen/Dense>
#include <optional>

namespace goingrate::timing_model {

/// What is known of the noise, and how much wider a sigma becomes for what the noise leaves
/// unexplained (see Certainty); the widening does not change the weights.
struct Weights {
  TimingNoise timing;
  double amplitude_rad = 0.0;
  double time_widening = 1.0;
  double amplitude_widening = 1.0;
};

/// What the full equation of motion adds to the averaged prediction; empty for none.
struct Correction {
  std::vector<double> residual_s;
  std::vector<double> amplitude;
};

/// A weak or stated prior on one search coordinate.
struct CoordinatePrior {
  std::size_t index;
  double centre;
  double sigma;
};

struct FitProblem {
  const TimingData& data;
  Parameters parameters;
  Weights weights;
  Correction correction;
  std::vector<CoordinatePrior> priors;
};

/// Whitened residuals of times, then of amplitudes, then priors; and their Jacobian by columns of
/// x.
struct Linearisation {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
  std::size_t times = 0;      ///< the first so many entries are times,
  std::size_t amplitudes = 0; ///< the next so many amplitudes
};

/// Nothing where the model does not hold.
std::optional<Linearisation> linearise(const FitProblem& problem, std::span<const double> x);

/// The outcome of a minimisation.
struct Minimum {
  bool usable = false;
  bool converged = false;
  double cost = 0.0; ///< half the sum of squares
  std::vector<double> x;
  std::string termination;
};

/// Runs Ceres from `start`.
Minimum minimise(const FitProblem& problem, std::vector<double> start, int iterations);

/// Residuals of time (s, mean removed) and model amplitudes at x.
std::optional<Prediction<double>> predict_at(const FitProblem& problem, std::span<const double> x);

/// The difference between the full equation of motion and the averaged one at x; nothing if the
/// full pendulum stops before the log ends.
std::optional<Correction> difference_to_direct(const FitProblem& problem,
                                               std::span<const double> x);

/// Velocity at the crossing over averaged amplitude in the limit cycle of the first clock; 1 if it
/// has none.
double limit_cycle_ratio(const Parameters& parameters, std::span<const double> x);

/// The most free parameters a fit may have: the width of the automatic derivatives.
inline constexpr std::size_t most_parameters = 16;

} // namespace goingrate::timing_model

// The likelihood of a log, its score and its information. Private to the fit room.
//
// Innovations e_i with variances F_i come from the filter (noise_filter.hpp), so
//   L = 1/2 sum (log F_i + e_i^2 / F_i) + 1/2 sum ((x_k - c_k)/s_k)^2 over priors
// is minus the log likelihood, but for a constant. Its gradient and the expected information are
//   sum of J' r and J' J over the rows  r = e/sqrt F,           J = de/sqrt F,
//                                       r = (1 - e^2/F)/sqrt 2,  J = dF/(sqrt 2 F),
// and rows r = (x - c)/s. The rows are not kept: they are folded into a triangle R and Q'r by
// orthogonal steps, which keeps the digits that a product J'J would lose.
#pragma once

#include "condensed.hpp"
#include "cycle_response.hpp"
#include "parameters.hpp"

#include "goingrate/fit/timing_data.hpp"

#include <Eigen/Dense>
#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// What other dynamics add to the averaged prediction; empty for nothing.
struct Correction {
  std::vector<double> late_s;    ///< when they cross less when the averaged clock does
  std::vector<double> amplitude; ///< turning angle
  /// To noise of the drive, where the model has any: of the clocks, and of each beat by one of
  /// them.
  std::shared_ptr<const std::deque<CycleResponses>> clocks;
  std::vector<ResponseAt> responses;
};

/// A weak or stated prior on one search coordinate.
struct CoordinatePrior {
  std::size_t index;
  double centre;
  double sigma;
  bool stated = false; ///< by the user
};

/// One model and the data it is to explain.
struct FitProblem {
  const TimingData* data = nullptr;
  Parameters parameters;
  Correction correction;
  std::vector<CoordinatePrior> priors;
  std::vector<std::array<double, 2>> bounds; ///< of each coordinate; empty: none
  /// If set, it stands for the data, and the correction is one at its nodes.
  std::shared_ptr<const CondensedLog> condensed;

  /// The same problem on other data, without a correction.
  [[nodiscard]] FitProblem on(const TimingData& other) const;
  /// Where the model is asked.
  [[nodiscard]] const TimingData& asked() const {
    return condensed != nullptr ? condensed->nodes() : *data;
  }
};

/// L, and with derivatives the triangle R (n x n, R'R = information) and Q'r (n): R'(Q'r) is the
/// gradient.
struct Evaluation {
  double value = 0.0; ///< L
  Eigen::MatrixXd triangle;
  Eigen::VectorXd projected;
  Eigen::MatrixXd amplitude_triangle; ///< of the rows of amplitudes alone
};

/// L at x; nothing where the model does not hold.
std::optional<double> minus_log_likelihood(const FitProblem& problem, std::span<const double> x);

/// The same with derivatives. Cost: O(N n^2) for N beats and n free parameters.
std::optional<Evaluation> evaluate(const FitProblem& problem, std::span<const double> x);

/// The same problem with every beat by itself.
FitProblem on_every_beat(const FitProblem& problem);

/// One entry a beat, NaN where there is none.
struct Residuals {
  std::vector<double> late_s;          ///< against the undisturbed course, mean removed
  std::vector<double> amplitude_model; ///< turning angle of that course
  std::vector<double> white_time;      ///< innovations over their standard deviation; one fewer
  std::vector<double> white_amplitude; ///< of the amplitudes that are known
};
std::optional<Residuals> residuals(const FitProblem& problem, std::span<const double> x);

/// The first and the last beat.
TimingData ends_of(const TimingData& data);
/// How much later the last beat is, against the first, than the model says; s. Nothing where the
/// model does not hold. Cost: that of a few beats.
std::optional<double> late_at_end(const Parameters& parameters, const TimingData& ends,
                                  std::span<const double> x);

/// The most free parameters a fit may have: the width of the automatic derivatives.
inline constexpr std::size_t most_parameters = 20;

} // namespace goingrate::timing_model

// The likelihood of a log, its score and its information. Private to the fit room.
//
// The filter (noise_filter.hpp) gives innovations e_i with variances F_i, so that
//   L = 1/2 sum (log F_i + e_i^2 / F_i) + 1/2 sum ((x_k - c_k)/s_k)^2 over priors
// is minus the log likelihood, up to a constant. Its gradient and the expected information are
//   sum of J' r and J' J over the rows  r = e/sqrt F,           J = de/sqrt F,
//                                       r = (1 - e^2/F)/sqrt 2,  J = dF/(sqrt 2 F),
// and over rows r = (x - c)/s. The rows are not stored: orthogonal steps fold them into a triangle
// R and Q'r, which keeps the digits that a product J'J would lose.
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

/// The correction that other dynamics make to the prediction of the averaged clock; empty if none.
struct Correction {
  std::vector<double> late_s;    ///< their crossing times minus those of the averaged clock
  std::vector<double> amplitude; ///< their turning angles minus those of the averaged clock
  /// How both change with the coordinates of the clock, which come before those of the noise; empty
  /// if the derivatives of the averaged clock are close enough.
  struct Slopes {
    std::vector<double> at;                             ///< the point of the corrections
    std::vector<std::vector<double>> late_s, amplitude; ///< for each coordinate, by beats
  };
  Slopes slopes;
  /// Responses to drive noise, if the model has any: one for each clock, and for each beat which of
  /// them applies.
  std::shared_ptr<const std::deque<CycleResponses>> clocks;
  std::vector<ResponseAt> responses;
};

/// A parameter after an event as a multiple of its value before; either value may be held.
struct RatioOfSlots {
  Slot after, before;
  double ratio = 1.0;
};

/// A prior on one search coordinate, either weak or stated by the user; or on a ratio, in which
/// case sigma is in the unit of the parameter.
struct CoordinatePrior {
  std::size_t index;
  double centre;
  double sigma;
  bool stated = false;
  std::optional<RatioOfSlots> planned{}; ///< then `index` and `centre` are not used

  /// How far x is from the centre, in sigma.
  [[nodiscard]] double pull(std::span<const double> x) const {
    if (!planned) return (x[index] - centre) / sigma;
    return (planned->after.value(x) - planned->ratio * planned->before.value(x)) / sigma;
  }
  /// d pull / d x[k].
  [[nodiscard]] double slope(std::span<const double> x, std::size_t k) const {
    if (!planned) return k == index ? 1.0 / sigma : 0.0;
    const auto part = [&](const Slot& slot) {
      return slot.free && slot.index == k ? slot.slope(x) : 0.0;
    };
    return (part(planned->after) - planned->ratio * part(planned->before)) / sigma;
  }
};

/// One model and the data it is to explain.
struct FitProblem {
  const TimingData* data = nullptr;
  Parameters parameters;
  Correction correction;
  std::vector<CoordinatePrior> priors;
  std::vector<std::array<double, 2>> bounds; ///< of each coordinate; empty if there are none
  /// If set, it replaces the data, and the correction has one entry per node.
  std::shared_ptr<const CondensedLog> condensed;

  /// The same problem on other data, without a correction or a condensed log.
  [[nodiscard]] FitProblem on(const TimingData& other) const;
  /// The beats at which the model is evaluated.
  [[nodiscard]] const TimingData& asked() const {
    return condensed != nullptr ? condensed->nodes() : *data;
  }
};

/// L with its derivatives: the triangle R (n x n, R'R = information) and Q'r (n), with R'(Q'r) the
/// gradient.
struct Evaluation {
  double value = 0.0; ///< L
  Eigen::MatrixXd triangle;
  Eigen::VectorXd projected;
  Eigen::MatrixXd amplitude_triangle; ///< R of the rows of amplitudes alone
};

/// L at x; empty where the model does not hold.
std::optional<double> minus_log_likelihood(const FitProblem& problem, std::span<const double> x);

/// L at x with its derivatives; empty where the model does not hold. Cost: O(N n^2) for N beats and
/// n free parameters.
std::optional<Evaluation> evaluate(const FitProblem& problem, std::span<const double> x);

/// The same problem with every beat of the log in place of the condensed log.
FitProblem on_every_beat(const FitProblem& problem);

/// One entry per beat, unless stated otherwise.
struct Residuals {
  std::vector<double> late_s;          ///< against the undisturbed course, mean removed
  std::vector<double> amplitude_model; ///< turning angle of that course
  std::vector<double> white_time; ///< innovations over their standard deviation; one entry fewer
  std::vector<double> white_amplitude; ///< the same, for known amplitudes only
};
std::optional<Residuals> residuals(const FitProblem& problem, std::span<const double> x);

/// The first beat, the last before each event, and the last of all.
TimingData ends_of_stretches(const TimingData& data, const std::vector<double>& event_cycles);
/// How much later each of these beats comes after the first than the model predicts, s, the first
/// left out; empty if the model does not hold.
std::optional<std::vector<double>> late_after_first(const Parameters& parameters,
                                                    const TimingData& ends,
                                                    std::span<const double> x);

/// The largest number of free parameters in a fit: the width of the automatic derivatives.
inline constexpr std::size_t most_parameters = 20;

} // namespace goingrate::timing_model

#include "likelihood.hpp"

#include "noise_filter.hpp"
#include "row_stack.hpp"

#include "goingrate/base/sums.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace goingrate::timing_model {

namespace {

template <class T> NoiseSizes<T> noise_sizes(const Parameters& parameters, std::span<const T> x) {
  NoiseSizes<T> noise;
  for (const Slot& slot : parameters.slots) {
    if (slot.quantity == Quantity::jitter_rms) noise.jitter = slot.value(x);
    if (slot.quantity == Quantity::walk_rms) noise.walk = slot.value(x);
    if (slot.quantity == Quantity::drive_rms) noise.drive = slot.value(x);
    if (slot.quantity == Quantity::slow_rms) noise.slow = slot.value(x);
    if (slot.quantity == Quantity::slow_time) noise.slow_time = slot.value(x);
    if (slot.quantity == Quantity::amplitude_rms) noise.amplitude = slot.value(x);
  }
  return noise;
}

// The filter for times disturbed only by jitter and a random walk: it has one state, and its gain
// does not depend on the clock. N is double if its derivatives are not asked for.
template <class N> class WalkFilter {
public:
  explicit WalkFilter(const NoiseSizes<N>& noise)
      : jitter2_(noise.jitter * noise.jitter), walk2_(noise.walk * noise.walk),
        walks_(plain(noise.walk) > 0.0) {}

  /// `relative2`: square of the noise of this time relative to the rms over all times.
  template <class T> void start(const T& late, double relative2, T& state) {
    state = late;
    covariance_ = jitter2_ * relative2;
  }
  /// Gives the innovation of the next time, `cycles` later, and updates `state` by it.
  template <class T>
  void see(const T& late, double relative2, double cycles, T& state, T& value, N& variance) {
    if (walks_) covariance_ += walk2_ * cycles;
    const N own = jitter2_ * relative2;
    variance = covariance_ + own;
    const N gain = covariance_ / variance;
    value = late - state;
    state += gain * value;
    covariance_ = gain * own;
  }

private:
  N jitter2_, walk2_;
  bool walks_;
  N covariance_{};
};

// The corrections for beat i at x.
template <class T>
T less_correction(T value, const std::vector<double>& there,
                  const std::vector<std::vector<double>>& slopes, const std::vector<double>& at,
                  std::span<const T> x, std::size_t i) {
  assert(there.empty() || i < there.size());
  if (!there.empty()) value -= there[i];
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    assert(i < slopes[k].size());
    value -= (x[k] - at[k]) * slopes[k][i];
  }
  return value;
}
template <class T>
T less_late_correction(const T& late, const Correction& c, std::span<const T> x, std::size_t i) {
  return less_correction(late, c.late_s, c.slopes.late_s, c.slopes.at, x, i);
}
template <class T>
T amplitude_of(const Sight<T>& sight, const Correction& c, std::span<const T> x, std::size_t i) {
  const T averaged = sight.laws->turning_angle(sight.amplitude2);
  return -less_correction(T(-averaged), c.amplitude, c.slopes.amplitude, c.slopes.at, x, i);
}

double squared_at(const std::vector<double>& relative, std::size_t i) {
  return relative.empty() ? 1.0 : relative[i] * relative[i];
}

template <class T> T amplitude_scale(const FitProblem& problem, std::span<const T> x) {
  const Slot* slot = problem.parameters.find(Quantity::amplitude_scale);
  return slot == nullptr ? T(1.0) : slot->value(x);
}

// Runs the model over the data and passes every innovation to see(i, value, variance, of_time).
// T carries derivatives of the prediction, N those of the noise.
template <class T, class N> class Run {
public:
  Run(const FitProblem& problem, std::span<const T> x)
      : problem_(problem), data_(*problem.data), x_(x), scale_(amplitude_scale(problem, x)) {
    if constexpr (std::is_same_v<T, N>) {
      noise_ = noise_sizes<N>(problem.parameters, x);
    } else {
      std::vector<double> values;
      for (const T& one : x)
        values.push_back(plain(one));
      noise_ = noise_sizes<double>(problem.parameters, values);
    }
  }

  template <class See> bool run(See&& see) {
    if constexpr (std::is_same_v<T, N>) {
      if (problem_.parameters.has(Quantity::slow_rms)) return disturbed<3>(see);
      if (problem_.parameters.has(Quantity::drive_rms)) return disturbed<2>(see);
    }
    return undisturbed(see);
  }

private:
  [[nodiscard]] T late(std::size_t i, const Sight<T>& sight) const {
    return less_late_correction(sight.late_s, problem_.correction, x_, i);
  }
  [[nodiscard]] bool sees_amplitude(std::size_t i) const {
    return data_.has_amplitude() && !std::isnan(data_.amplitude_rad[i]);
  }
  [[nodiscard]] T amplitude_excess(std::size_t i, const Sight<T>& sight) const {
    return data_.amplitude_rad[i] - amplitude_of(sight, problem_.correction, x_, i) * scale_;
  }

  template <class See> bool undisturbed(See&& see) {
    WalkFilter<N> filter(noise_);
    T state{};
    double before = 0.0;
    const N amplitude_variance = noise_.amplitude * noise_.amplitude;
    return Follower<T>(problem_.parameters, x_, data_).run([&](std::size_t i, const auto& sight) {
      if (i == 0) {
        filter.start(late(i, sight), squared_at(data_.time_noise, i), state);
      } else {
        T value;
        N variance;
        filter.see(late(i, sight), squared_at(data_.time_noise, i), data_.cycle[i] - before, state,
                   value, variance);
        see(i, value, variance, true);
      }
      before = data_.cycle[i];
      if (sees_amplitude(i))
        see(i, amplitude_excess(i, sight),
            amplitude_variance * squared_at(data_.amplitude_noise, i), false);
    });
  }

  template <std::size_t D, class See> bool disturbed(See&& see) {
    const auto& responses = problem_.correction.responses;
    NoiseFilter<T, D> filter(noise_, !responses.empty() && data_.has_amplitude());
    double before = 0.0;
    return Follower<T>(problem_.parameters, x_, data_).run([&](std::size_t i, const auto& sight) {
      const ResponseAt response = responses.empty() ? ResponseAt{} : responses[i];
      if (i == 0) {
        filter.start(sight, response, late(i, sight));
      } else {
        filter.pass(sight, response, data_.cycle[i] - before);
        const auto seen = filter.see_time(late(i, sight));
        see(i, seen.value, seen.variance, true);
      }
      before = data_.cycle[i];
      if (sees_amplitude(i)) {
        const auto seen = filter.see_amplitude(sight, response, amplitude_excess(i, sight), scale_,
                                               squared_at(data_.amplitude_noise, i));
        see(i, seen.value, seen.variance, false);
      }
    });
  }

  const FitProblem& problem_;
  const TimingData& data_;
  std::span<const T> x_;
  T scale_; // amplitude in the log's column over that of the pendulum
  NoiseSizes<N> noise_;
};

double prior_cost(const FitProblem& problem, std::span<const double> x) {
  double sum = 0.0;
  for (const CoordinatePrior& prior : problem.priors)
    sum += 0.5 * std::pow(prior.pull(x), 2);
  return sum;
}

// The two sums in L, in compensated arithmetic: in a long log the last gains of a search are 1e-12
// of them.
struct LikelihoodSums {
  TwoPart<double> squares, logs;
  [[nodiscard]] double value() const { return 0.5 * (squares.value() + logs.value()); }
};

// The weighted lateness at the nodes of a condensed log, followed by its derivatives, one column
// each; empty where the model does not hold.
template <class T>
std::optional<Eigen::MatrixXd> weighted_lateness(const FitProblem& problem, std::span<const T> x) {
  constexpr bool slopes = !std::is_same_v<T, double>;
  const TimingData& nodes = problem.condensed->nodes();
  const auto columns = static_cast<Eigen::Index>(slopes ? x.size() + 1 : 1);
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(nodes.size()), columns);
  const bool holds =
      Follower<T>(problem.parameters, x, nodes).run([&](std::size_t i, const auto& sight) {
        const auto row = static_cast<Eigen::Index>(i);
        const T late = less_late_correction(sight.late_s, problem.correction, x, i);
        rows(row, 0) = plain(late);
        if constexpr (slopes)
          for (Eigen::Index k = 1; k < columns; ++k)
            rows(row, k) = late.v[k - 1];
      });
  if (!holds) return {};
  return problem.condensed->weighted(rows);
}

double jitter2(const FitProblem& problem, std::span<const double> x) {
  return std::pow(noise_sizes<double>(problem.parameters, x).jitter, 2);
}

// L, without priors, of N - 1 innovations with variances jitter^2 (i + 1)/i.
double condensed_value(const FitProblem& problem, double squares, double jitter2) {
  const double n = problem.condensed->beats();
  return 0.5 * (squares / jitter2 + (n - 1.0) * std::log(jitter2) + std::log(n));
}

// Adds one innovation to sums and rows.
template <class T, class N>
void fold_in(const T& value, const N& variance, LikelihoodSums& sums, RowStack& rows) {
  const double root = 1.0 / std::sqrt(plain(variance));
  const double white = plain(value) * root;
  sums.squares += white * white;
  sums.logs += std::log(plain(variance));
  rows.add(white, [&](Eigen::Index k) { return value.v[k] * root; });
  if constexpr (!std::is_same_v<N, double>) {
    const double scale = std::sqrt(0.5) * root * root;
    rows.add((1.0 - white * white) * std::sqrt(0.5),
             [&](Eigen::Index k) { return variance.v[k] * scale; });
  }
}

// The rows (1 - e^2/F)/sqrt 2 of innovations whose variances F are all proportional to the square
// of one size, combined into one. `squares` is the sum of e^2/F.
void add_row_of_size(const Parameters& parameters, Quantity size, double innovations,
                     double squares, RowStack& rows) {
  const Slot* slot = parameters.find(size);
  if (slot == nullptr || !slot->free || innovations == 0.0) return;
  const double slope = std::sqrt(2.0 * innovations);
  rows.add((innovations - squares) / slope, [&](Eigen::Index k) {
    return static_cast<std::size_t>(k) == slot->index ? slope : 0.0;
  });
}

void add_priors(const FitProblem& problem, std::span<const double> x, RowStack& rows) {
  for (const CoordinatePrior& prior : problem.priors)
    rows.add(prior.pull(x),
             [&](Eigen::Index k) { return prior.slope(x, static_cast<std::size_t>(k)); });
}

template <class T> std::vector<T> jets_at(std::span<const double> x) {
  std::vector<T> jets;
  for (std::size_t k = 0; k < x.size(); ++k)
    jets.emplace_back(x[k], static_cast<int>(k));
  return jets;
}

std::optional<Evaluation> if_finite(Evaluation&& result) {
  const bool finite =
      std::isfinite(result.value) && result.triangle.allFinite() && result.projected.allFinite();
  return finite ? std::optional(std::move(result)) : std::nullopt;
}

template <int n>
std::optional<Evaluation> evaluate_condensed(const FitProblem& problem, std::span<const double> x) {
  using T = ceres::Jet<double, n>;
  const std::vector<T> jets = jets_at<T>(x);
  const auto late = weighted_lateness<T>(problem, jets);
  if (!late) return {};
  const auto unknowns = static_cast<Eigen::Index>(x.size());
  RowStack rows(unknowns);
  const double variance = jitter2(problem, x), root = 1.0 / std::sqrt(variance);
  for (Eigen::Index i = 0; i < late->rows(); ++i)
    rows.add((*late)(i, 0) * root, [&](Eigen::Index k) { return (*late)(i, k + 1) * root; });
  const double squares = problem.condensed->rest_s2() + late->col(0).squaredNorm();
  const double innovations = problem.condensed->beats() - 1.0;
  add_row_of_size(problem.parameters, Quantity::jitter_rms, innovations, squares / variance, rows);
  add_priors(problem, x, rows);
  Evaluation result;
  result.value = condensed_value(problem, squares, variance) + prior_cost(problem, x);
  result.triangle = rows.triangle();
  result.projected = rows.projected();
  result.amplitude_triangle = RowStack(unknowns).triangle();
  return if_finite(std::move(result));
}

template <int n, bool noisy>
std::optional<Evaluation> evaluate_with(const FitProblem& problem, std::span<const double> x) {
  using T = ceres::Jet<double, n>;
  using N = std::conditional_t<noisy, T, double>;
  const std::vector<T> jets = jets_at<T>(x);
  const auto unknowns = static_cast<Eigen::Index>(x.size());
  RowStack rows(unknowns), amplitude_rows(unknowns);
  Evaluation result;
  LikelihoodSums sums, of_amplitude;
  Run<T, N> run(problem, jets);
  double times = 0.0, amplitudes = 0.0;
  if (!run.run([&](std::size_t, const T& value, const N& variance, bool of_time) {
        ++(of_time ? times : amplitudes);
        fold_in(value, variance, of_time ? sums : of_amplitude, of_time ? rows : amplitude_rows);
      }))
    return {};
  if constexpr (!noisy) {
    const Parameters& parameters = problem.parameters;
    add_row_of_size(parameters, Quantity::jitter_rms, times, sums.squares.value(), rows);
    add_row_of_size(parameters, Quantity::amplitude_rms, amplitudes, of_amplitude.squares.value(),
                    amplitude_rows);
  }
  result.amplitude_triangle = amplitude_rows.triangle();
  rows.add(amplitude_rows);
  add_priors(problem, x, rows);
  result.value = sums.value() + of_amplitude.value() + prior_cost(problem, x);
  result.triangle = rows.triangle();
  result.projected = rows.projected();
  return if_finite(std::move(result));
}

} // namespace

FitProblem FitProblem::on(const TimingData& other) const {
  FitProblem problem = *this;
  problem.data = &other;
  problem.correction = {};
  problem.condensed.reset();
  return problem;
}

FitProblem on_every_beat(const FitProblem& problem) {
  FitProblem every = problem;
  every.condensed.reset();
  if (problem.condensed != nullptr && !problem.correction.late_s.empty()) {
    every.correction.late_s = problem.condensed->spread(problem.correction.late_s);
    every.correction.amplitude = problem.condensed->spread(problem.correction.amplitude);
    for (auto* slopes : {&every.correction.slopes.late_s, &every.correction.slopes.amplitude})
      for (std::vector<double>& slope : *slopes)
        slope = problem.condensed->spread(slope);
  }
  return every;
}

std::optional<double> minus_log_likelihood(const FitProblem& problem, std::span<const double> x) {
  if (problem.condensed != nullptr) {
    const auto late = weighted_lateness<double>(problem, x);
    if (!late) return {};
    const double squares = problem.condensed->rest_s2() + late->squaredNorm();
    const double total =
        condensed_value(problem, squares, jitter2(problem, x)) + prior_cost(problem, x);
    return std::isfinite(total) ? std::optional(total) : std::nullopt;
  }
  LikelihoodSums sums;
  double product = 1.0;
  Run<double, double> run(problem, x);
  const bool holds = run.run([&](std::size_t, double value, double variance, bool) {
    sums.squares += value * value / variance;
    product *= variance; // one logarithm for several factors saves time
    if (product < 1e-200 || product > 1e200) {
      sums.logs += std::log(product);
      product = 1.0;
    }
  });
  sums.logs += std::log(product);
  const double total = sums.value() + prior_cost(problem, x);
  return holds && std::isfinite(total) ? std::optional(total) : std::nullopt;
}

std::optional<Evaluation> evaluate(const FitProblem& problem, std::span<const double> x) {
  // Noise without derivatives costs less: with no noise but jitter every variance is a multiple of
  // one size. The effect of drive noise depends on the clock, so its variances have derivatives
  // even if its size is held fixed.
  const Parameters& parameters = problem.parameters;
  const bool walks =
      parameters.has(Quantity::walk_rms) &&
      (parameters.is_free(Quantity::walk_rms) || parameters.is_free(Quantity::jitter_rms));
  const bool noisy =
      walks || parameters.has(Quantity::drive_rms) || parameters.has(Quantity::slow_rms);
  const auto of_width = [&](auto width) {
    constexpr int n = decltype(width)::value;
    if (problem.condensed != nullptr) return evaluate_condensed<n>(problem, x);
    return noisy ? evaluate_with<n, true>(problem, x) : evaluate_with<n, false>(problem, x);
  };
  // Narrower derivatives cost less; multiples of four are inlined and fill the processor's
  // registers.
  if (x.size() <= 4) return of_width(std::integral_constant<int, 4>());
  if (x.size() <= 8) return of_width(std::integral_constant<int, 8>());
  if (x.size() <= 12) return of_width(std::integral_constant<int, 12>());
  return of_width(std::integral_constant<int, static_cast<int>(most_parameters)>());
}

TimingData ends_of_stretches(const TimingData& data, const std::vector<double>& event_cycles) {
  std::vector<std::size_t> ends{0};
  const auto add = [&](std::size_t beats) { // how many come before the stretch ends
    if (beats > ends.back() + 1) ends.push_back(beats - 1);
  };
  for (const double cycle : event_cycles)
    add(static_cast<std::size_t>(std::upper_bound(data.cycle.begin(), data.cycle.end(), cycle) -
                                 data.cycle.begin()));
  add(data.size());
  return subset(data, ends);
}

std::optional<std::vector<double>>
late_after_first(const Parameters& parameters, const TimingData& ends, std::span<const double> x) {
  std::vector<double> late;
  double first = 0.0;
  const bool holds =
      Follower<double>(parameters, x, ends).run([&](std::size_t i, const auto& sight) {
        if (i == 0)
          first = sight.late_s;
        else
          late.push_back(sight.late_s - first);
      });
  return holds ? std::optional(std::move(late)) : std::nullopt;
}

std::optional<Residuals> residuals(const FitProblem& problem, std::span<const double> x) {
  if (problem.condensed != nullptr) return residuals(on_every_beat(problem), x);
  const TimingData& data = *problem.data;
  Residuals result;
  Run<double, double> run(problem, x);
  if (!run.run([&](std::size_t, double value, double variance, bool of_time) {
        (of_time ? result.white_time : result.white_amplitude)
            .push_back(value / std::sqrt(variance));
      }))
    return {};
  const double scale = amplitude_scale(problem, x);
  result.late_s.reserve(data.size());
  result.amplitude_model.reserve(data.size());
  Follower<double>(problem.parameters, x, data).run([&](std::size_t i, const auto& sight) {
    result.late_s.push_back(less_late_correction(sight.late_s, problem.correction, x, i));
    result.amplitude_model.push_back(scale * amplitude_of(sight, problem.correction, x, i));
  });
  const double mean = std::accumulate(result.late_s.begin(), result.late_s.end(), 0.0) /
                      static_cast<double>(data.size());
  for (double& late : result.late_s)
    late -= mean;
  return result;
}

} // namespace goingrate::timing_model

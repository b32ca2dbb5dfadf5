#include "inference.hpp"

#include "final_clock.hpp"

#include "base/scaled_time.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <numeric>

namespace goingrate::timing_model {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
// A value is determined if its three-sigma interval excludes zero.
constexpr double largest_relative_sigma = 1.0 / 3.0;

using Quality = std::function<double(std::span<const double>)>;

// Value and sigma of a function of the coordinates, by central differences of a thousandth of each
// coordinate's own sigma or unit.
DerivedQuantity derive(std::string name, std::string expression, std::string unit,
                       const Quality& function, std::span<const double> x, const Certainty& known) {
  Eigen::VectorXd gradient(static_cast<Eigen::Index>(x.size()));
  std::vector<double> moved(x.begin(), x.end());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double step = 1e-3 * std::min(0.1, known.sigma(k));
    moved[k] = x[k] + step;
    const double up = function(moved);
    moved[k] = x[k] - step;
    const double down = function(moved);
    moved[k] = x[k];
    gradient[static_cast<Eigen::Index>(k)] = step > 0.0 ? (up - down) / (2.0 * step) : 0.0;
  }
  return {std::move(name), std::move(expression), std::move(unit), function(x),
          (known.factor.transpose() * gradient).norm()};
}

constexpr double rivals_apart = 3.5; // sigma: beyond what three sigma of likelihood allow

bool rivals_agree(const Rivals& rivals, const DerivedQuantity& best, const Quality& function) {
  return std::all_of(rivals.begin(), rivals.end(), [&](const Rival& rival) {
    return std::abs(function(rival.x) - best.value) <= rivals_apart * best.sigma;
  });
}

DerivedQuantity unless_undetermined(DerivedQuantity quantity) {
  if (!(quantity.sigma <= largest_relative_sigma * std::abs(quantity.value)))
    quantity.value = quantity.sigma = unknown;
  return quantity;
}

bool friction_known(const FitProblem& problem, const Certainty& known) {
  bool trusted = true;
  for (const Slot& slot : problem.parameters.slots)
    if (slot.quantity == Quantity::epsilon && slot.free) trusted = !known.distrusted[slot.index];
  return trusted;
}

std::string unit_of(const FitProblem& problem, const Slot& slot) {
  switch (slot.quantity) {
  case Quantity::T0:
  case Quantity::jitter_rms:
  case Quantity::walk_rms:
  case Quantity::slow_time:
    return "s";
  case Quantity::phi0:
  case Quantity::lambda0:
  case Quantity::offset:
  case Quantity::amplitude_rms:
    return "rad";
  case Quantity::term:
    return problem.data->terms[slot.term].unit;
  default:
    return "";
  }
}

bool has_prior(const FitOptions& options, const std::string& name) {
  return std::any_of(options.priors.begin(), options.priors.end(),
                     [&](const Prior& prior) { return prior.name == name; });
}

// The log adds nothing to the weak prior about the start.
bool tells_nothing(const FitProblem& problem, const Slot& slot, double sigma) {
  constexpr double largest_prior_share = 0.5; // of the prior's sigma
  return std::any_of(problem.priors.begin(), problem.priors.end(), [&](const auto& prior) {
    return prior.index == slot.index && !prior.stated && sigma > largest_prior_share * prior.sigma;
  });
}

void state_free(const FitProblem& problem, const Slot& slot, std::span<const double> x,
                const Certainty& known, const Interval& interval, FittedParameter& parameter) {
  const double sigma = known.sigma(slot.index);
  parameter.sigma = sigma * std::abs(slot.slope(x));
  const auto value_at = [&](double coordinate) {
    std::vector<double> at(x.begin(), x.end());
    at[slot.index] = coordinate;
    return slot.value(std::span<const double>(at));
  };
  parameter.low68 = value_at(interval.low68);
  parameter.high68 = value_at(interval.high68);
  parameter.low95 = value_at(interval.low95);
  parameter.high95 = value_at(interval.high95);
  if (!problem.bounds.empty()) {
    const auto [low, high] = problem.bounds[slot.index];
    const double near = 1e-6 * std::max(1.0, std::abs(x[slot.index]));
    parameter.at_bound = x[slot.index] - low < near || high - x[slot.index] < near;
  }
  const bool open = !std::isfinite(interval.low68) || !std::isfinite(interval.high68);
  const bool vague = !(sigma <= tolerable_sigma(problem, slot, x)) &&
                     (!may_vanish(slot) || tells_nothing(problem, slot, sigma));
  if (vague || (open && !parameter.at_bound) || known.distrusted[slot.index]) {
    parameter.status = ParameterStatus::undetermined;
    parameter.value = parameter.sigma = unknown;
    parameter.low68 = parameter.high68 = parameter.low95 = parameter.high95 = unknown;
  }
}

void state_parameters(const FitProblem& problem, std::span<const double> x, const Certainty& known,
                      const std::vector<Interval>& intervals, const FitOptions& options,
                      FitSummary& summary) {
  for (const Slot& slot : problem.parameters.slots) {
    FittedParameter parameter;
    parameter.name = problem.parameters.name_of(slot);
    parameter.unit = unit_of(problem, slot);
    parameter.value = slot.value(x);
    parameter.sigma = parameter.model_shift = unknown;
    parameter.low68 = parameter.high68 = parameter.low95 = parameter.high95 = unknown;
    parameter.status = slot.free ? ParameterStatus::free : ParameterStatus::fixed;
    if (slot.free && has_prior(options, parameter.name)) parameter.status = ParameterStatus::prior;
    if (slot.free) state_free(problem, slot, x, known, intervals[slot.index], parameter);
    parameter.sigma_by_law = parameter.sigma;
    summary.parameters.push_back(parameter);
  }
}

void state_correlation(const FitProblem& problem, const Certainty& known, FitSummary& summary) {
  const Eigen::MatrixXd covariance = known.covariance();
  const auto n = covariance.rows();
  for (const Slot& slot : problem.parameters.slots)
    if (slot.free) summary.correlated.push_back(problem.parameters.name_of(slot));
  for (Eigen::Index i = 0; i < n; ++i) {
    std::vector<double> row;
    for (Eigen::Index k = 0; k < n; ++k)
      row.push_back(covariance(i, k) / std::sqrt(covariance(i, i) * covariance(k, k)));
    summary.correlation.push_back(row);
  }
}

// The variance that noise of the drive adds to the times, s^2 a cycle: by the slow gain if the log
// is long enough to show it, else by the larger of the two gains.
double walk_per_cycle(const FitProblem& problem, std::span<const double> x, const Certainty& known,
                      const Rivals& rivals) {
  const auto of = [&](Quantity quantity, std::span<const double> at) {
    const Slot* slot = problem.parameters.find(quantity);
    return slot == nullptr ? 0.0 : slot->value(at);
  };
  const Quality in_the_long_run = [&](std::span<const double> at) {
    const FinalClock clock = final_clock(problem.parameters, at);
    const double fast = of(Quantity::drive_rms, at), slow = of(Quantity::slow_rms, at);
    const double memory = of(Quantity::slow_time, at) / clock.T0;
    return std::abs(clock.T0 * clock.slow_gain()) *
           std::sqrt(fast * fast + 2.0 * memory * slow * slow);
  };
  const double walk = of(Quantity::walk_rms, x);
  double size = in_the_long_run(x);
  if (problem.parameters.has(Quantity::drive_rms)) {
    const DerivedQuantity settled = derive("", "", "", in_the_long_run, x, known);
    const FinalClock clock = final_clock(problem.parameters, x);
    if (!(settled.sigma < largest_relative_sigma * settled.value) ||
        !rivals_agree(rivals, settled, in_the_long_run))
      size = std::max(size, size * std::abs(clock.fast_gain() / clock.slow_gain()));
  }
  return walk * walk + size * size;
}

// Scatter of the mean rates of eight parts of the log; infinite if the log is too short for that.
double scatter_of_parts(const TimingData& data) {
  constexpr std::size_t parts = 8, least_beats = 4; // beats in each
  if (data.size() < parts * least_beats) return std::numeric_limits<double>::infinity();
  std::array<double, parts> rates{};
  for (std::size_t k = 0; k < parts; ++k) {
    const std::size_t from = k * (data.size() - 1) / parts,
                      to = (k + 1) * (data.size() - 1) / parts;
    rates[k] = (data.lateness_s[to] - data.lateness_s[from]) / (data.cycle[to] - data.cycle[from]);
  }
  const double mean = std::accumulate(rates.begin(), rates.end(), 0.0) / parts;
  double sum2 = 0.0;
  for (const double rate : rates)
    sum2 += (rate - mean) * (rate - mean);
  return std::sqrt(sum2 / (parts - 1));
}

// Mean period of the log: from end to end of the model under noise that walks, else of a straight
// line; no flat ridge of the clock's parameters can touch it. Sigma: jitter at both ends of a line
// of N times, j sqrt(12/N)/n, and the walk. A noise whose size the log does not determine counts
// for no more than the scatter of the rates of eight parts of the log.
DerivedQuantity mean_period(const FitProblem& problem, std::span<const double> x,
                            const Certainty& known, const Rivals& rivals, double widening) {
  const TimingData& data = *problem.data;
  const double per_cycle = walk_per_cycle(problem, x, known, rivals);
  const double jitter = problem.parameters.find(Quantity::jitter_rms)->value(x);
  const double cycles = data.cycle.back(), beats = static_cast<double>(data.size());
  const double sigma_of_line = jitter * std::sqrt(12.0 / beats) / cycles;
  const double sigma = std::hypot(sigma_of_line, std::sqrt(per_cycle / cycles));
  double period = data.reference_period_s; // from end to end
  if (per_cycle == 0.0) {
    double sum = 0.0, weight = 0.0, mean = 0.0;
    for (const double c : data.cycle)
      mean += c / beats;
    for (std::size_t i = 0; i < data.size(); ++i) {
      sum += (data.cycle[i] - mean) * data.lateness_s[i];
      weight += (data.cycle[i] - mean) * (data.cycle[i] - mean);
    }
    period += sum / weight;
  }
  double widened = widening * sigma;
  if (per_cycle > 0.0) widened = std::min(widened, std::max(sigma_of_line, scatter_of_parts(data)));
  return {"mean period", per_cycle == 0.0 ? "slope of the times" : "(t_N - t_0)/N", "s", period,
          widened};
}

// The random walk of the times is drive_rms times the fast gain, which is ε √((λ/φ0)² - 1) under a
// constant torque and linear friction. With ε known, only the ratio λ/φ0 is unknown.
double least_drive(const FitProblem& problem, std::span<const double> x) {
  constexpr double most_ratio = 4.0; // of λ and φ0 in pendulum clocks
  const Slot* drive = problem.parameters.find(Quantity::drive_rms);
  const FinalClock clock = final_clock(problem.parameters, x);
  return drive->value(x) * std::abs(clock.fast_gain()) /
         (clock.laws.epsilon * std::sqrt(most_ratio * most_ratio - 1.0));
}

void state_combinations(const FitProblem& problem, std::span<const double> x,
                        const Certainty& known, const Rivals& rivals, double nominal_period_s,
                        double time_widening, FitSummary& summary) {
  const auto of_place = [&](std::string name, std::string expression, std::string unit,
                            const Quality& function) {
    auto quantity =
        derive(std::move(name), std::move(expression), std::move(unit), function, x, known);
    if (!rivals_agree(rivals, quantity, function))
      quantity.sigma = std::numeric_limits<double>::infinity();
    return unless_undetermined(std::move(quantity));
  };
  const auto of_clock = [&](std::string name, std::string expression, std::string unit, auto get) {
    return of_place(
        std::move(name), std::move(expression), std::move(unit),
        [&, get](std::span<const double> at) { return get(final_clock(problem.parameters, at)); });
  };
  const bool driven = problem.parameters.escapement != Escapement::none;
  const bool linear = !problem.parameters.has(Quantity::quadratic_drag) &&
                      !problem.parameters.has(Quantity::dry_friction);
  summary.q_factor = of_clock("Q", linear ? "1/(2 epsilon)" : "at the stationary amplitude", "",
                              [](const FinalClock& c) { return c.q_factor(); });
  summary.decay_time =
      of_clock("decay time", linear ? "T0/(2 pi epsilon)" : "T0 Q/pi at the stationary amplitude",
               "s", [](const FinalClock& c) { return c.T0 * c.q_factor() / std::numbers::pi; });
  summary.stationary_amplitude =
      of_clock("stationary amplitude", "where drive and friction balance", "rad",
               [](const FinalClock& c) { return std::sqrt(c.amplitude2); });
  const auto relaxation = of_clock("relaxation time", "of the squared amplitude", "s",
                                   [](const FinalClock& c) { return 0.5 * c.decay_time(); });
  const auto fast = of_clock("fast gain", "rate per relative drive, amplitude frozen", "",
                             [](const FinalClock& c) { return c.fast_gain(); });
  const auto slow = of_clock("slow gain", "rate per relative drive, amplitude settled", "",
                             [](const FinalClock& c) { return c.slow_gain(); });
  // Without an observed relaxation the stationary state is unknown too.
  // A pendulum without a drive has no stationary amplitude, and Q depends on the amplitude unless
  // friction is linear.
  if (!std::isfinite(summary.decay_time.value) || !friction_known(problem, known) ||
      (!driven && !linear))
    for (DerivedQuantity* quantity :
         {&summary.q_factor, &summary.decay_time, &summary.stationary_amplitude})
      quantity->value = quantity->sigma = unknown;
  if (!driven) summary.stationary_amplitude.value = summary.stationary_amplitude.sigma = unknown;

  const DerivedQuantity period = mean_period(problem, x, known, rivals, time_widening);
  summary.rate_s_per_day = {"rate", "T0_nominal/mean period - 1", "s/day",
                            seconds_gained_per_day(nominal_period_s / period.value - 1.0),
                            seconds_gained_per_day(period.sigma / period.value)};
  summary.combinations.push_back(period);
  // A search that did not converge determines no combination of parameters.
  const bool settled =
      std::find(known.distrusted.begin(), known.distrusted.end(), false) != known.distrusted.end();
  if (!settled) {
    for (DerivedQuantity* quantity :
         {&summary.q_factor, &summary.decay_time, &summary.stationary_amplitude})
      quantity->value = quantity->sigma = unknown;
    return;
  }
  const auto add_if_known = [&](const DerivedQuantity& quantity) {
    if (std::isfinite(quantity.value)) summary.combinations.push_back(quantity);
  };
  for (const Slot& slot : problem.parameters.slots)
    if (slot.quantity == Quantity::T0 && slot.event > 0)
      add_if_known(
          of_place(problem.parameters.name_of(slot) + "/T0 - 1",
                   "relative, of the period of small swings", "", [&](std::span<const double> at) {
                     const double before = problem.parameters.find(Quantity::T0)->value(at);
                     return slot.value(at) / before - 1.0;
                   }));
  add_if_known(summary.decay_time);
  if (!driven) return;
  add_if_known(relaxation);
  add_if_known(summary.stationary_amplitude);
  add_if_known(fast);
  add_if_known(slow);
  const FittedParameter* drive = summary.find("drive_rms");
  if (drive == nullptr || drive->status != ParameterStatus::undetermined ||
      summary.model.escapement != Escapement::constant_torque)
    return;
  add_if_known(of_place("least fast drive", "if λ is at most 4 φ0", "",
                        [&](std::span<const double> at) { return least_drive(problem, at); }));
}

// T0 is the mean period less the circular and escapement errors. If the escapement error (the fast
// gain times the drive) is undetermined, so is T0, whatever the curvature is at the point of the
// flat ridge where the search ended.
void doubt_T0_without_gain(FitSummary& summary) {
  const bool known =
      summary.model.escapement == Escapement::none || summary.combination("fast gain") != nullptr;
  for (FittedParameter& p : summary.parameters)
    if (!known && p.name == "T0" && p.status == ParameterStatus::free) {
      p.status = ParameterStatus::undetermined;
      p.value = p.sigma = p.low68 = p.high68 = p.low95 = p.high95 = unknown;
    }
}

} // namespace

bool may_vanish(const Slot& slot) {
  return slot.coordinate == Coordinate::multiple && slot.quantity != Quantity::mu;
}

double tolerable_sigma(const FitProblem& problem, const Slot& slot, std::span<const double> x) {
  // Where several noises share the scatter, each size is stated even if known only to a factor; its
  // interval shows the factor.
  constexpr double factor = 1.0;
  if (is_noise(slot.quantity) && problem.parameters.has(Quantity::drive_rms)) return factor;
  if (slot.coordinate == Coordinate::logarithm) return largest_relative_sigma;
  if (slot.coordinate == Coordinate::multiple) {
    double largest = 0.0;
    for (const Slot& other : problem.parameters.slots)
      if (other.quantity == slot.quantity) largest = std::max(largest, std::abs(other.value(x)));
    return largest_relative_sigma * largest / slot.scale;
  }
  // T0 differs from the mean period by the rate excess. It counts as determined if its sigma is a
  // small part of that correction.
  const FinalClock clock = final_clock(problem.parameters, x);
  Going<double> start;
  apply_changes(problem.parameters, x, 0, start);
  const double lambda2 = std::max(clock.amplitude2, start.amplitude2_start);
  return largest_relative_sigma * (lambda2 / 16.0 + std::abs(clock.fast_gain()));
}

Certainty certainty(const FitProblem& problem, const Evaluation& at, const Widening& widening) {
  const auto n = at.triangle.rows();
  Certainty known;
  known.distrusted.assign(static_cast<std::size_t>(n), false);
  known.unwidened =
      at.triangle.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
  const double times = std::pow(widening.time, 2), amplitudes = std::pow(widening.amplitude, 2);
  if (times == 1.0 && amplitudes == 1.0) {
    known.factor = known.unwidened;
    return known;
  }
  // The curvature with widened priors, times and amplitudes, transformed by R^-1, in which M = 1.
  const Eigen::MatrixXd of_amplitudes = at.amplitude_triangle * known.unwidened;
  Eigen::MatrixXd middle = times * Eigen::MatrixXd::Identity(n, n) +
                           (amplitudes - times) * of_amplitudes.transpose() * of_amplitudes;
  for (const CoordinatePrior& prior : problem.priors) {
    const Eigen::RowVectorXd row =
        known.unwidened.row(static_cast<Eigen::Index>(prior.index)) / prior.sigma;
    middle += (1.0 - times) * row.transpose() * row;
  }
  const Eigen::LLT<Eigen::MatrixXd> root(middle);
  known.factor = root.info() == Eigen::Success
                     ? Eigen::MatrixXd(known.unwidened * root.matrixL().toDenseMatrix())
                     : Eigen::MatrixXd(known.unwidened * widening.largest());
  return known;
}

void distrust_by_rivals(const Rivals& rivals, std::span<const double> x, Certainty& known) {
  for (std::size_t k = 0; k < known.distrusted.size(); ++k) {
    const double sigma = known.sigma(k);
    double added = 0.0; // to the variance: share times distance squared, in units of it
    for (const Rival& rival : rivals) {
      const double distance = std::abs(rival.x[k] - x[k]) / sigma;
      if (distance > rivals_apart) known.distrusted[k] = true;
      // The distance expected for this sigma at this deficit, or sigma itself.
      if (distance * distance < 1.0 + 2.0 * rival.behind) continue;
      added = std::max(added, rival.share() * distance * distance);
    }
    known.factor.row(static_cast<Eigen::Index>(k)) *= std::sqrt(1.0 + added);
  }
  const Eigen::MatrixXd covariance = known.covariance();
  const std::vector<bool> doubted = known.distrusted;
  for (std::size_t k = 0; k < doubted.size(); ++k)
    for (std::size_t j = 0; j < doubted.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(k), column = static_cast<Eigen::Index>(j);
      const double size = std::sqrt(covariance(row, row) * covariance(column, column));
      if (doubted[j] && std::abs(covariance(row, column)) > 0.99 * size) known.distrusted[k] = true;
    }
}

Eigen::VectorXd shift_by(const FitProblem& problem, std::span<const double> x,
                         const Correction& correction) {
  FitProblem corrected = problem;
  corrected.correction = correction;
  const auto there = evaluate(corrected, x);
  const auto n = static_cast<Eigen::Index>(x.size());
  if (!there) return Eigen::VectorXd::Zero(n);
  // Minus one step of scoring, which leads from here to the other minimum.
  return there->triangle.triangularView<Eigen::Upper>().solve(there->projected);
}

void state_results(const FitProblem& problem, std::span<const double> x, const Certainty& known,
                   const std::vector<Interval>& intervals, const Rivals& rivals,
                   const FitOptions& options, double nominal_period_s, FitSummary& summary) {
  state_parameters(problem, x, known, intervals, options, summary);
  state_correlation(problem, known, summary);
  state_combinations(problem, x, known, rivals, nominal_period_s, summary.time_widening, summary);
  doubt_T0_without_gain(summary);
}

} // namespace goingrate::timing_model

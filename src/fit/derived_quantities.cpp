#include "derived_quantities.hpp"

#include "final_clock.hpp"

#include "base/scaled_time.hpp"
#include "base/special_values.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <numeric>

namespace goingrate::timing_model {

namespace {

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

bool rivals_agree(const Rivals& rivals, const DerivedQuantity& best, const Quality& function) {
  return std::all_of(rivals.begin(), rivals.end(), [&](const Rival& rival) {
    return std::abs(function(rival.x) - best.value) <= rivals_apart * best.sigma;
  });
}

DerivedQuantity unless_undetermined(DerivedQuantity quantity) {
  if (!(quantity.sigma <= largest_relative_sigma * std::abs(quantity.value)))
    quantity.value = quantity.sigma = not_known;
  return quantity;
}

// A quantity that depends on an undetermined parameter is not stated: if the friction is
// undetermined, linear sigmas of quantities that depend on it hold only at one point of a long
// valley.
bool friction_known(const FitSummary& summary) {
  const FittedParameter* friction = summary.find("epsilon");
  return friction == nullptr || friction->status != ParameterStatus::undetermined;
}

// The variance that noise of the drive adds to the times, s^2 per cycle: by the slow gain if the
// log is long enough to show it, else by the larger of the two gains.
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

// Mean period of the log: from end to end of the model if its noise makes the times walk, else the
// slope of a straight line. No flat ridge of the clock's parameters can affect it. Sigma: that of a
// line through N times with jitter, j sqrt(12/N)/n, and the walk. Noise whose size the log does not
// determine contributes no more than the scatter of the rates of eight parts of the log.
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

// Quantities at the fitted point.
class AtPlace {
public:
  AtPlace(const FitProblem& problem, std::span<const double> x, const Certainty& known,
          const Rivals& rivals)
      : problem_(problem), x_(x), known_(known), rivals_(rivals) {}

  [[nodiscard]] DerivedQuantity of_place(std::string name, std::string expression, std::string unit,
                                         const Quality& function) const {
    auto quantity =
        derive(std::move(name), std::move(expression), std::move(unit), function, x_, known_);
    if (!rivals_agree(rivals_, quantity, function))
      quantity.sigma = std::numeric_limits<double>::infinity();
    return unless_undetermined(std::move(quantity));
  }
  template <class Get>
  [[nodiscard]] DerivedQuantity of_clock(std::string name, std::string expression, std::string unit,
                                         Get get) const {
    return of_place(
        std::move(name), std::move(expression), std::move(unit),
        [&, get](std::span<const double> at) { return get(final_clock(problem_.parameters, at)); });
  }

private:
  const FitProblem& problem_;
  std::span<const double> x_;
  const Certainty& known_;
  const Rivals& rivals_;
};

// The name of the parameter after its last change: a quantity of the clock at the end of the log
// depends on that.
std::string last_name_of(Quantity quantity, const Parameters& parameters) {
  std::string name;
  for (const Slot& slot : parameters.slots)
    if (slot.quantity == quantity) name = parameters.name_of(slot);
  return name;
}

void state_stationary(const FitProblem& problem, const AtPlace& place, FitSummary& summary) {
  const bool driven = problem.parameters.escapement != Escapement::none;
  const bool linear = !problem.parameters.has(Quantity::quadratic_drag) &&
                      !problem.parameters.has(Quantity::dry_friction);
  const std::string friction = last_name_of(Quantity::epsilon, problem.parameters),
                    period = last_name_of(Quantity::T0, problem.parameters);
  summary.q_factor = place.of_clock(
      "Q", linear ? fmt::format("1/(2 {})", friction) : "at the stationary amplitude", "",
      [](const FinalClock& c) { return c.q_factor(); });
  summary.decay_time = place.of_clock(
      "decay time",
      linear ? fmt::format("{}/(2 pi {})", period, friction)
             : fmt::format("{} Q/pi at the stationary amplitude", period),
      "s", [](const FinalClock& c) { return c.T0 * c.q_factor() / std::numbers::pi; });
  summary.stationary_amplitude =
      place.of_clock("stationary amplitude", "where drive and friction balance", "rad",
                     [](const FinalClock& c) { return std::sqrt(c.amplitude2); });
  // Without an observed relaxation the stationary state is unknown too.
  // A pendulum without a drive has no stationary amplitude, and Q depends on the amplitude unless
  // friction is linear.
  if (!std::isfinite(summary.decay_time.value) || !friction_known(summary) || (!driven && !linear))
    for (DerivedQuantity* quantity :
         {&summary.q_factor, &summary.decay_time, &summary.stationary_amplitude})
      quantity->value = quantity->sigma = not_known;
  if (!driven) summary.stationary_amplitude.value = summary.stationary_amplitude.sigma = not_known;
}

// Combinations other than the mean period.
void state_combinations(const FitProblem& problem, const AtPlace& place, FitSummary& summary) {
  const auto add_if_known = [&](const DerivedQuantity& quantity) {
    if (std::isfinite(quantity.value)) summary.combinations.push_back(quantity);
  };
  for (const Slot& slot : problem.parameters.slots)
    if (slot.quantity == Quantity::T0 && slot.event > 0)
      add_if_known(place.of_place(
          problem.parameters.name_of(slot) + "/T0 - 1", "relative, of the period of small swings",
          "", [&](std::span<const double> at) {
            const double before = problem.parameters.find(Quantity::T0)->value(at);
            return slot.value(at) / before - 1.0;
          }));
  add_if_known(summary.decay_time);
  if (problem.parameters.escapement == Escapement::none) return;
  const auto relaxation = place.of_clock("relaxation time", "of the squared amplitude", "s",
                                         [](const FinalClock& c) { return 0.5 * c.decay_time(); });
  const auto fast = place.of_clock("fast gain", "rate per relative drive, amplitude frozen", "",
                                   [](const FinalClock& c) { return c.fast_gain(); });
  const auto slow = place.of_clock("slow gain", "rate per relative drive, amplitude settled", "",
                                   [](const FinalClock& c) { return c.slow_gain(); });
  if (friction_known(summary))
    for (const DerivedQuantity& quantity : {relaxation, summary.stationary_amplitude, fast, slow})
      add_if_known(quantity);
  const FittedParameter* drive = summary.find("drive_rms");
  const FittedParameter* friction = summary.find("epsilon");
  const bool at_bound = friction != nullptr && friction->at_bound; // no curvature there
  if (drive == nullptr || drive->status != ParameterStatus::undetermined ||
      summary.model.escapement != Escapement::constant_torque || at_bound)
    return;
  add_if_known(
      place.of_place("least fast drive", "if λ is at most 4 φ0", "",
                     [&](std::span<const double> at) { return least_drive(problem, at); }));
}

// T0 is the mean period less the circular and escapement errors. If the escapement error (the fast
// gain times the drive) is undetermined, so is T0, whatever the curvature is at the point of the
// flat ridge where the search ended.
void doubt_T0_without_gain(FitSummary& summary) {
  const bool known =
      summary.model.escapement == Escapement::none || summary.combination("fast gain") != nullptr;
  for (FittedParameter& p : summary.parameters)
    if (!known && p.name == "T0" && p.status == ParameterStatus::free) leave_undetermined(p);
}

} // namespace

void state_derived(const FitProblem& problem, std::span<const double> x, const Certainty& known,
                   const Rivals& rivals, double nominal_period_s, FitSummary& summary) {
  const AtPlace place(problem, x, known, rivals);
  state_stationary(problem, place, summary);
  const DerivedQuantity period = mean_period(problem, x, known, rivals, summary.time_widening);
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
      quantity->value = quantity->sigma = not_known;
  } else {
    state_combinations(problem, place, summary);
  }
  doubt_T0_without_gain(summary);
}

} // namespace goingrate::timing_model

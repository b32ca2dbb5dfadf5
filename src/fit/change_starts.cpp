#include "change_starts.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace goingrate::timing_model {

namespace {

using std::numbers::pi;

// What a log shows of one change; jump and difference are rates relative to that before it.
struct SeenChange {
  double epsilon = 0.0, jump = 0.0, difference = 0.0;
};

// Regression of the lateness on a line, the contribution of the jump, and those of relaxations with
// the first `powers` powers of the exponential.
struct Regressed {
  Eigen::VectorXd size;
  double squares = std::numeric_limits<double>::infinity();
};

Regressed regressed(const TimingData& data, double at, double epsilon, int powers) {
  const auto n = static_cast<Eigen::Index>(data.size());
  Eigen::MatrixXd design(n, 3 + powers);
  Eigen::VectorXd late(n);
  const double whole = data.cycle.back();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double cycle = data.cycle[static_cast<std::size_t>(i)], since = std::max(0.0, cycle - at);
    late[i] = data.lateness_s[static_cast<std::size_t>(i)];
    design(i, 0) = 1.0;
    design(i, 1) = cycle / whole;
    design(i, 2) = since;
    for (int power = 1; power <= powers; ++power) {
      const double speed = 4.0 * pi * epsilon * power; // relaxation rate, 1/cycle
      design(i, 2 + power) = since + std::expm1(-speed * since) / speed;
    }
  }
  const auto solver = design.colPivHouseholderQr();
  Regressed found;
  found.size = solver.solve(late);
  found.squares = (late - design * found.size).squaredNorm();
  return found;
}

SeenChange seen_with(const TimingData& data, double at, double epsilon) {
  constexpr int powers = 2; // the rate is nonlinear in lambda^2
  const Regressed found = regressed(data, at, epsilon, powers);
  const double jump = -found.size[2] / data.reference_period_s;
  return {epsilon, jump, jump - (found.size[3] + found.size[4]) / data.reference_period_s};
}

// Likely values of epsilon: those of the best one and two exponentials, and a smaller one to allow
// for the nonlinearity of a large change.
std::vector<double> likely_frictions(const TimingData& data, double at) {
  constexpr double least_epsilon = 3e-5, most_epsilon = 6e-3, factor = 1.12;
  const auto best = [&](int powers) {
    double found = least_epsilon, squares = std::numeric_limits<double>::infinity();
    for (double epsilon = least_epsilon; epsilon < most_epsilon; epsilon *= factor) {
      const double here = regressed(data, at, epsilon, powers).squares;
      if (here < squares) {
        squares = here;
        found = epsilon;
      }
    }
    return found;
  };
  constexpr double bend_factor = 1.3; // shift of epsilon by the nonlinearity of a large change
  const double one = best(1), two = best(2);
  return {one, two, one / bend_factor};
}

struct Clock {
  double epsilon = 0.0, mu = 0.0, phi0 = 0.0, lambda = 0.0, changed = 0.0;
};

// The clock with u = sqrt(S - 1) before a change of `quantity` by `factor`, if there is one.
std::optional<Clock> clock_of(double epsilon, double u, double kappa, Quantity quantity,
                              double factor) {
  constexpr double most_angle = 0.3, least_angle = 1e-3; // rad, of plausible clocks
  if (!(kappa > 0.0) || !(factor > 0.05 && factor < 20.0)) return {};
  const double phi0 = 4.0 * std::sqrt(kappa), S = 1.0 + u * u;
  if (phi0 < least_angle || phi0 > most_angle) return {};
  Clock clock{epsilon, pi * epsilon * S * phi0 / 2.0, phi0, phi0 * std::sqrt(S), 0.0};
  clock.changed = factor * (quantity == Quantity::mu     ? clock.mu
                            : quantity == Quantity::phi0 ? clock.phi0
                                                         : clock.epsilon);
  return clock;
}

void add_clocks(const SeenChange& seen, Quantity quantity, double u, std::vector<Clock>& clocks) {
  const double S = 1.0 + u * u, j = seen.jump / seen.epsilon;
  const auto add = [&](double epsilon, double factor, double steep, double growth) {
    const double kappa = (epsilon * (steep - u) - seen.difference) / ((growth - 1.0) * S);
    if (const auto clock = clock_of(epsilon, u, kappa, quantity, factor)) clocks.push_back(*clock);
  };
  if (quantity == Quantity::mu) {
    const double f = 1.0 + j / u;
    if (f * S > 1.0) add(seen.epsilon, f, std::sqrt(f * S - 1.0), f);
  } else if (quantity == Quantity::phi0) {
    const double g2 = S - std::pow(u + j, 2);
    if (g2 > 0.0 && g2 < S * S)
      add(seen.epsilon, std::sqrt(g2), std::sqrt(S / std::sqrt(g2) - 1.0), std::sqrt(g2));
  } else {
    for (const double h : {0.45, 0.65, 0.85, 1.3, 2.0}) {
      const double before = seen.epsilon / h; // the log shows the relaxation after the change
      if (S > h) add(before, h, h * std::sqrt(S / h - 1.0), 1.0 / h);
    }
  }
}

std::vector<double> coordinates(const Clock& clock, const Parameters& parameters, double period_s,
                                std::span<const double> otherwise) {
  std::vector<double> x(otherwise.begin(), otherwise.end());
  for (const Slot& slot : parameters.slots) {
    if (!slot.free || !is_of_clock(slot.quantity)) continue;
    std::optional<double> value;
    if (slot.event > 0)
      value = clock.changed;
    else if (slot.quantity == Quantity::T0)
      value = period_s;
    else if (slot.quantity == Quantity::epsilon)
      value = clock.epsilon;
    else if (slot.quantity == Quantity::mu)
      value = clock.mu;
    else if (slot.quantity == Quantity::phi0)
      value = clock.phi0;
    else if (slot.quantity == Quantity::lambda0)
      value = clock.lambda;
    if (value) x[slot.index] = slot.coordinate_of(*value);
  }
  return x;
}

// The quantity that changes, if the model is one for which starts are made.
std::optional<Quantity> what_changes(const Parameters& parameters) {
  if (parameters.escapement != Escapement::constant_torque || parameters.event_cycles.size() != 1)
    return {};
  std::optional<Quantity> changes;
  for (const Slot& slot : parameters.slots) {
    if (slot.event == 0) continue;
    if (changes || !slot.free) return {};
    changes = slot.quantity;
  }
  if (changes != Quantity::mu && changes != Quantity::phi0 && changes != Quantity::epsilon)
    return {};
  for (const Quantity needed : {Quantity::mu, Quantity::phi0, Quantity::epsilon, Quantity::lambda0})
    if (!parameters.is_free(needed)) return {};
  return changes;
}

} // namespace

std::vector<std::vector<std::vector<double>>> starts_by_change(const Parameters& parameters,
                                                               const TimingData& data,
                                                               std::span<const double> otherwise) {
  const auto quantity = what_changes(parameters);
  constexpr std::size_t fewest_beats = 8; // columns of the regression, and some to spare
  if (!quantity || data.size() < fewest_beats) return {};
  const double at = parameters.event_cycles.front();
  std::vector<std::vector<std::vector<double>>> stretches;
  for (const double epsilon : likely_frictions(data, at)) {
    SeenChange seen = seen_with(data, at, epsilon);
    if (*quantity == Quantity::epsilon) seen.jump = 0.0;
    constexpr double least_u = 0.3, most_u = 4.0;  // range of u
    constexpr double factor = 1.06, stretch = 1.5; // ratios of u, from clock to clock
    for (double first = least_u; first < most_u; first *= stretch) {
      std::vector<Clock> clocks;
      for (double u = first; u < std::min(first * stretch, most_u); u *= factor)
        add_clocks(seen, *quantity, u, clocks);
      auto& points = stretches.emplace_back();
      for (const Clock& clock : clocks)
        points.push_back(coordinates(clock, parameters, data.reference_period_s, otherwise));
    }
  }
  return stretches;
}

} // namespace goingrate::timing_model

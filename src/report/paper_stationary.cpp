// Stationary operation: sec. statop, and the numbers that later sections quote from it.
#include "paper_rates.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/dynamics/operating_point.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate::paper {

namespace {

// The friction at which the rate is greatest, at a given torque: a golden-section search.
template <class Rate> double best_friction(const Rate& rate) {
  const double share = 0.5 * (std::sqrt(5.0) - 1.0);
  double low = 1e-4, high = 4e-4;
  constexpr int rounds = 40; // of a factor 0.618: finer than a flat maximum can be located
  for (int i = 0; i < rounds; ++i) {
    const double a = high - share * (high - low), b = low + share * (high - low);
    (rate(a) > rate(b) ? high : low) = rate(a) > rate(b) ? b : a;
  }
  return 0.5 * (low + high);
}

} // namespace

void add_stationary(std::vector<PaperNumber>& numbers) {
  const double phi0 = point_a().phi0, epsilon = point_a().epsilon;
  numbers.push_back({"least torque that keeps A's friction going", "Sec. IV", "π/2 ε φ0",
                     stall_torque(epsilon, phi0), *exact_stall_torque(epsilon, phi0), "",
                     "the swing is no sinusoid: 5 φ0²/96 of itself lower"});
  numbers.push_back({"gain at A", "Sec. V", "1.1e-4, ~10 s/day",
                     rk4_rate(point_a(), Rk4Torque::per_stage), exact_rate(point_a()), "",
                     "RK4's phase error -dt⁴/120 = -6.8e-9, and where in a step it switches"});
  numbers.push_back({"gain at B", "Sec. V", "~2e-4, ~17 s/day",
                     rk4_rate(point_b(), Rk4Torque::per_stage), exact_rate(point_b()), "",
                     "the same"});
  KnownPair nominal;
  nominal.mu = 1.5e-5;
  nominal.rate_excess = 0.0;
  // This torque keeps two clocks at nominal rate; C is the one with the wider swing, on the dashed
  // line in fig. rate beyond which more torque makes the clock lose.
  const auto friction = [&](Equations equations) {
    const auto points = operating_points(nominal, phi0, equations);
    return points.empty() ? not_known : points.back().epsilon;
  };
  numbers.push_back({"friction at which μ = 1.5e-5 keeps nominal time (C)", "Sec. VI",
                     "1.167245e-4", friction(Equations::first_order), friction(Equations::exact),
                     "", "first order calls a clock nominal that gains 1.8e-8"});
  const auto at_mu = [&](double e) { return ClockParameters{2.0, e, 2e-5, phi0}; };
  const double fastest = best_friction([&](double e) { return exact_rate(at_mu(e)); });
  const double least = exact_rate(at_mu(fastest)) - exact_rate(at_mu(2.5e-4));
  numbers.push_back(
      {"friction of the fastest clock at μ = 2e-5", "Sec. IV A", "~2.5e-4",
       best_friction([&](double e) { return first_order_rate(at_mu(e)); }), fastest, "",
       fmt::format("read off a figure, and the maximum is flat: at 2.5e-4 the clock gains {:.1f} "
                   "s/day less; between our two, second order",
                   seconds_per_day * least)});
  const ClockParameters loser{2.0, 5e-5, 1e-5, phi0};
  numbers.push_back({"rate at ε 5e-5, μ 1e-5", "Fig. 3", "loses about 10 s/day",
                     seconds_per_day * first_order_rate(loser), seconds_per_day * exact_rate(loser),
                     "s/day",
                     "read off a figure whose own formula gives our first; to our second, second "
                     "order"});
  numbers.push_back({"amplitude there over φ0", "Fig. 3", "about 2",
                     *stationary_amplitude(loser) / phi0, limit_cycle(loser)->velocity / phi0, "",
                     "a cycle's mean against φ' at the crossing"});
}

} // namespace goingrate::paper

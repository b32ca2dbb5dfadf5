#include "goingrate/report/paper.hpp"

#include "paper_figures.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/base/thread_clock.hpp"
#include "goingrate/dynamics/moments.hpp"
#include "goingrate/dynamics/operating_point.hpp"
#include "goingrate/dynamics/stationary.hpp"
#include "json_parts.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace goingrate {

namespace {

using namespace paper;
using std::numbers::pi;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double step = 0.03; // the paper's dt

double exact_rate(const ClockParameters& clock) { return limit_cycle(clock)->rate_excess; }
double first_order_rate(const ClockParameters& clock) {
  return *stationary_rate_first_order(clock);
}

Scenario scenario_of(const ClockParameters& clock, std::int64_t periods, Method method) {
  Scenario scenario;
  scenario.clock = clock;
  scenario.periods = periods;
  scenario.method.method = method;
  scenario.method.dt = step;
  return scenario;
}

// The mean rate over all but the first tenth of a run.
double mean_rate(const Scenario& scenario) {
  ClockRun run(scenario, 0);
  double begin_s = 0.0, end_s = 0.0;
  std::int64_t begin = 0, end = 0;
  while (const auto period = run.next()) {
    if (period->cycle == *scenario.periods / 10) {
      begin = period->cycle;
      begin_s = period->time_s.value();
    }
    end = period->cycle;
    end_s = period->time_s.value();
  }
  return static_cast<double>(end - begin) * scenario.clock.nominal_period_s / (end_s - begin_s) -
         1.0;
}

double rk4_rate(const ClockParameters& clock, Rk4Torque torque) {
  Scenario scenario = scenario_of(clock, 4000, Method::rk4);
  scenario.method.rk4_torque = torque;
  return mean_rate(scenario);
}

// The friction at which the rate is greatest, at a given torque: a golden-section search.
template <class Rate> double best_friction(const Rate& rate) {
  const double share = 0.5 * (std::sqrt(5.0) - 1.0);
  double low = 1e-4, high = 4e-4;
  constexpr int rounds = 40; // of a factor 0.618: beyond the flatness of a maximum
  for (int i = 0; i < rounds; ++i) {
    const double a = high - share * (high - low), b = low + share * (high - low);
    (rate(a) > rate(b) ? high : low) = rate(a) > rate(b) ? b : a;
  }
  return 0.5 * (low + high);
}

// The area between the rate after the jump and that of B at the end, in phase.
double phase_gained(Method method) {
  ClockRun run(jump_scenario(20000, method), 0);
  double at_jump = 0.0, end = 0.0, reference_rate = 0.0;
  std::int64_t cycles = 0;
  const double T0 = point_a().nominal_period_s;
  while (const auto period = run.next()) {
    if (period->cycle == 150) at_jump = period->time_s.value();
    end = period->time_s.value();
    reference_rate = period->rate_excess;
    cycles = period->cycle - 150;
  }
  const double scaled = (end - at_jump) * two_pi / T0;
  return two_pi * static_cast<double>(cycles) - (1.0 + reference_rate) * scaled;
}

void add_stationary(std::vector<PaperNumber>& numbers) {
  const double phi0 = point_a().phi0, epsilon = point_a().epsilon;
  numbers.push_back({"least torque that keeps A's friction going", "sec. statop",
                     "pi/2 epsilon phi0", stall_torque(epsilon, phi0),
                     *exact_stall_torque(epsilon, phi0), "",
                     "the swing is no sinusoid: 5 phi0^2/96 of itself lower"});
  numbers.push_back({"gain at A", "sec. such", "1.1e-4, ~10 s/day",
                     rk4_rate(point_a(), Rk4Torque::per_stage), exact_rate(point_a()), "",
                     "RK4's phase error -dt^4/120 = -6.8e-9, and where in a step it switches"});
  numbers.push_back({"gain at B", "sec. such", "~2e-4, ~17 s/day",
                     rk4_rate(point_b(), Rk4Torque::per_stage), exact_rate(point_b()), "",
                     "the same"});
  KnownPair nominal;
  nominal.mu = 1.5e-5;
  nominal.rate_excess = 0.0;
  const auto friction = [&](Equations equations) {
    double found = unknown;
    for (const OperatingPoint& p : operating_points(nominal, phi0, equations))
      if (std::abs(p.epsilon - 1.167e-4) < 1e-6) found = p.epsilon;
    return found;
  };
  numbers.push_back({"friction at which mu = 1.5e-5 keeps nominal time (C)", "sec. perst",
                     "1.167245e-4", friction(Equations::first_order), friction(Equations::exact),
                     "", "first order calls a clock nominal that gains 1.8e-8"});
  const auto at_mu = [&](double e) { return ClockParameters{2.0, e, 2e-5, phi0}; };
  numbers.push_back({"friction of the fastest clock at mu = 2e-5", "sec. losgain", "~2.5e-4",
                     best_friction([&](double e) { return first_order_rate(at_mu(e)); }),
                     best_friction([&](double e) { return exact_rate(at_mu(e)); }), "",
                     "the maximum is flat: the rate there differs by 1e-8 only"});
  const ClockParameters loser{2.0, 5e-5, 1e-5, phi0};
  numbers.push_back({"rate at epsilon 5e-5, mu 1e-5", "fig. rate", "loses about 10 s/day",
                     seconds_per_day * first_order_rate(loser), seconds_per_day * exact_rate(loser),
                     "s/day", "second order"});
  numbers.push_back({"amplitude there over phi0", "fig. rate", "about 2",
                     *stationary_amplitude(loser) / phi0, limit_cycle(loser)->velocity / phi0, "",
                     "a cycle's mean against phi' at the crossing"});
}

double rate_after_jump(Method method) {
  ClockRun run(jump_scenario(151, method), 0);
  double rate = 0.0;
  while (const auto period = run.next())
    rate = period->rate_excess;
  return rate;
}

void add_jump(std::vector<PaperNumber>& numbers) {
  const ClockParameters a = point_a(), b = point_b();
  const double lambda = *stationary_amplitude(a);
  const double cosine = std::sqrt(1.0 - std::pow(a.phi0 / lambda, 2));
  numbers.push_back({"rate just after the jump from A to B", "sec. such", "3.2e-4",
                     first_order_rate(a) + 2.0 * (b.mu - a.mu) * cosine / (pi * lambda),
                     rate_after_jump(Method::direct), "",
                     "the amplitude grows by 3e-3 in the first period"});
  numbers.push_back({"phase gained after the jump", "sec. such", "0.295",
                     phase_gained(Method::averaged1), phase_gained(Method::direct), "rad",
                     "second order"});
  numbers.push_back({"the same for a 1 m pendulum", "sec. such", "~0.1 s",
                     phase_gained(Method::averaged1) / pi, phase_gained(Method::direct) / pi, "s",
                     "second order"});
}

void add_long_run(const NoisyRun& noisy, std::vector<PaperNumber>& numbers) {
  constexpr double year_s = 365.25 * seconds_per_day;
  const double exact = exact_rate(point_c());
  numbers.push_back({"steps of 0.03 in a nominal period", "sec. such", "~209", two_pi / step,
                     two_pi / step, "", "none"});
  numbers.push_back({"nominal periods in 1e9 steps", "sec. perst", "~4.8e6", 1e9 * step / two_pi,
                     1e9 * step / two_pi, "", "none"});
  numbers.push_back({"the same at 2 s", "sec. perst", "about 110 days",
                     1e9 * step / pi / seconds_per_day, 1e9 * step / pi / seconds_per_day, "d",
                     "none"});
  numbers.push_back({"gain at C without variability", "sec. perst", "1e-8",
                     rk4_rate(point_c(), Rk4Torque::per_stage), exact, "",
                     "RK4's own phase error is -6.8e-9; the budget below has the rest"});
  numbers.push_back({"the same with the torque chosen once a step", "app. appnum", "",
                     rk4_rate(point_c(), Rk4Torque::per_step), exact, "",
                     "the switch comes half a step late: first order, 300 times too much"});
  numbers.push_back({"the same in a year", "sec. perst", "0.3 s/yr",
                     year_s * rk4_rate(point_c(), Rk4Torque::per_stage), year_s * exact, "s/yr",
                     "the same"});
  const DriveResponse response = *drive_response(point_c());
  const double random = response.slow_gain * 0.3 * std::sqrt(1.0 / noisy.noisy_periods);
  numbers.push_back({"rms gain by the driving noise over its 4.3e6 periods", "sec. perst", "~1e-8",
                     std::abs(random), noisy.rms_gain, "",
                     "theory: slow gain times 0.3/sqrt(N); ours: sixteen runs, known to a fifth"});
  numbers.push_back({"mean gain by that noise", "sec. perst", "", unknown, noisy.mean_gain, "",
                     "the rate is no straight line in the drive; the paper does not part it from "
                     "the rms"});
  numbers.push_back({"secular difference between pendulum and model, with noise", "sec. perst",
                     "~1e-8", noisy.secular, noisy.secular_in_full, "",
                     "ours: the model with the circular error of eq. ce3; what is left is second "
                     "order"});
}

double ns_per_period(Scenario scenario) {
  ClockRun run(scenario, 1);
  const double seconds = thread_seconds([&] {
    while (run.next()) {
    }
  });
  return 1e9 * seconds / static_cast<double>(*scenario.periods);
}

void add_times(std::vector<PaperNumber>& numbers) {
  constexpr double all = 4.774648e6 * 1e-9; // periods, s per ns
  Scenario rk4 = scenario_of(point_c(), 20000, Method::rk4);
  Scenario map = scenario_of(point_c(), 1000000, Method::map);
  Scenario averaged = scenario_of(point_c(), 1000000, Method::averaged1);
  for (Scenario* scenario : {&rk4, &map, &averaged})
    scenario->drive.fast_rms = 0.3;
  numbers.push_back({"time of the simulation", "fig. quasistat", "1e4 s (IDL)",
                     all * ns_per_period(rk4), all * ns_per_period(map), "s",
                     "RK4 compiled; the return map, which is exact to rounding"});
  const double model = all * ns_per_period(averaged);
  numbers.push_back({"time of the averaged equations", "sec. disc", "~50 s", model, model, "s",
                     "closed forms, one period a step"});
}

// Exact rate at C less first order, part by part.
std::vector<BudgetPart> budget_at_c() {
  const ClockParameters c = point_c();
  const double lambda = *stationary_amplitude(c), first = first_order_rate(c);
  const double second = mean_rate(scenario_of(c, 3000, Method::averaged2));
  const double exact = exact_rate(c);
  const double circular = circular_error(lambda) + lambda * lambda / 16.0;
  const double friction = -0.5 * c.epsilon * c.epsilon;
  const double rest = second - first - circular - friction;
  return {{"first order, by eq. statrate", first},
          {"circular error beyond lambda^2/16: J1(lambda)/lambda - 1/2 (eq. ce3), lambda^4/384",
           circular},
          {"the oscillator's own -epsilon^2/2", friction},
          {"the rest of second-order averaging: the swing's shape and the switches with it", rest},
          {"beyond second order", exact - second},
          {"sum: the full equation of motion", exact},
          {"error of RK4 at dt = 0.03, torque chosen in every stage",
           rk4_rate(c, Rk4Torque::per_stage) - exact},
          {"what RK4 shows, and the paper saw", rk4_rate(c, Rk4Torque::per_stage)}};
}

std::string number_text(double value) {
  return std::isnan(value) ? std::string() : fmt::format("{:.7g}", value);
}

} // namespace

PaperResults recompute_paper(const PaperOptions& options) {
  constexpr std::int64_t least = 10000;
  if (options.periods < least)
    throw ArgumentError("periods", static_cast<double>(options.periods), "10000 or more");
  PaperResults results;
  const NoisyRun noisy = noisy_run(options);
  add_stationary(results.numbers);
  add_jump(results.numbers);
  add_long_run(noisy, results.numbers);
  add_times(results.numbers);
  results.budget = budget_at_c();
  results.figures = figures(noisy);
  return results;
}

std::string paper_text(const PaperResults& results) {
  std::string text = "# Hoyng's paper, computed again\n\n"
                     "| what | where | printed | by the paper's method | ours | unit | why they "
                     "differ |\n|---|---|---|---|---|---|---|\n";
  for (const PaperNumber& n : results.numbers)
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", n.what, n.where, n.printed,
                        number_text(n.by_paper), number_text(n.ours), n.unit, n.why);
  text += "\n## What the secular 1e-8 at C is made of\n\n| part | rate |\n|---|---|\n";
  for (const BudgetPart& part : results.budget)
    text += fmt::format("| {} | {:+.4e} |\n", part.what, part.rate);
  return text;
}

std::string paper_json(const PaperResults& results) {
  Json json = json_with_schema("goingrate.paper");
  json["numbers"] = Json::array();
  for (const PaperNumber& n : results.numbers)
    json["numbers"].push_back({{"what", n.what},
                               {"where", n.where},
                               {"printed", n.printed},
                               {"by_paper", json_number(n.by_paper)},
                               {"ours", json_number(n.ours)},
                               {"unit", n.unit},
                               {"why", n.why}});
  json["budget"] = Json::array();
  for (const BudgetPart& part : results.budget)
    json["budget"].push_back({{"what", part.what}, {"rate", json_number(part.rate)}});
  return json.dump(2) + "\n";
}

} // namespace goingrate

// The noisy run of months: sec. perst, fig. quasistat.
#include "paper_rates.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/base/thread_clock.hpp"
#include "goingrate/dynamics/moments.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <numbers>
#include <span>

namespace goingrate::paper {

namespace {

using std::numbers::pi;

constexpr std::int64_t plotted_every = 500; // as in the paper

using Factors = std::shared_ptr<const std::vector<double>>;

Factors noisy_drive(const PaperOptions& options) {
  auto factors =
      std::make_shared<std::vector<double>>(static_cast<std::size_t>(options.periods), 1.0);
  RandomStream random(options.seed, StreamPurpose::fast_drive);
  for (std::size_t i = factors->size() / 10; i < factors->size(); ++i)
    (*factors)[i] = 1.0 + drive_rms * random.normal();
  return factors;
}

Scenario noisy_scenario(Method method, const Factors& factors) {
  Scenario scenario = scenario_of(point_c(), static_cast<std::int64_t>(factors->size()), method);
  scenario.drive.series = factors;
  return scenario;
}

// psi - t, scaled, at the crossing that ends a period.
double gain_of(const Period& period, double T0) {
  const double scaled = two_pi / T0;
  return -scaled * (TwoPart<double>(period.time_s) +=
                    TwoPart<double>{-T0 * static_cast<double>(period.cycle), 0.0})
                       .value();
}

// psi - t at every 500th crossing, and the CPU time spent; `each` is called for every period.
template <class Each>
std::vector<double> gains(const Scenario& scenario, const PaperOptions& options,
                          std::string_view what, double& seconds, Each each) {
  ClockRun run(scenario, 0);
  std::vector<double> gained;
  const double T0 = scenario.clock.nominal_period_s;
  const std::int64_t told_every = std::max<std::int64_t>(*scenario.periods / 20, 1);
  seconds = thread_seconds([&] {
    while (const auto period = run.next()) {
      each(*period);
      if (period->cycle % plotted_every == 0) gained.push_back(gain_of(*period, T0));
      if (options.now && period->cycle % told_every == 0)
        options.now(fmt::format("{}: {:.0f} %", what,
                                100.0 * static_cast<double>(period->cycle) /
                                    static_cast<double>(*scenario.periods)));
    }
  });
  return gained;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> less;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    less.push_back(a[i] - b[i]);
  return less;
}

double slope(std::span<const double> x, std::span<const double> y) {
  double mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += x[i] / n;
    my += y[i] / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    xy += (x[i] - mx) * (y[i] - my);
  }
  return xy / xx;
}

// Fits two lines, because the difference bends where the noise begins.
Secular secular(std::span<const double> periods, std::span<const double> unsolved) {
  const std::size_t steady = periods.size() / 10;
  return {slope(periods.first(steady), unsolved.first(steady)) / two_pi,
          slope(periods.subspan(steady), unsolved.subspan(steady)) / two_pi};
}

} // namespace

NoisyRun noisy_run(const PaperOptions& options) {
  const Factors factors = noisy_drive(options);
  const auto nothing = [](const Period&) {};
  NoisyRun run;
  run.by_rk4 = gains(noisy_scenario(Method::rk4, factors), options,
                     "Fig. 6 by RK4, as the paper did", run.rk4_s, nothing);
  run.gained = gains(noisy_scenario(Method::map, factors), options, "the same by the return map",
                     run.map_s, nothing);
  double beyond = 0.0; // phase due to the terms of eq. A1 beyond -lambda^2/16
  std::vector<double> beyond_there;
  const auto model =
      gains(noisy_scenario(Method::averaged1, factors), options,
            "the same by the averaged equations", run.model_s, [&](const Period& period) {
              const double lambda = period.velocity;
              beyond += two_pi * (circular_error(lambda) + lambda * lambda / 16.0);
              if (period.cycle % plotted_every == 0) beyond_there.push_back(-beyond);
            });
  double untold_s = 0.0;
  const auto second = gains(noisy_scenario(Method::averaged2, factors), options,
                            "the same by those of second order", untold_s, nothing);
  run.unsolved_in_full = difference(run.gained, model);
  run.unsolved = difference(run.unsolved_in_full, beyond_there);
  run.unsolved_by_rk4 = difference(difference(run.by_rk4, model), beyond_there);
  run.unsolved_by_second = difference(run.gained, second);
  for (std::size_t i = 0; i < run.unsolved_in_full.size(); ++i)
    run.periods.push_back(static_cast<double>(plotted_every) * static_cast<double>(i + 1));
  run.secular = secular(run.periods, run.unsolved);
  run.secular_by_rk4 = secular(run.periods, run.unsolved_by_rk4);
  run.secular_in_full = secular(run.periods, run.unsolved_in_full);
  run.secular_by_second = secular(run.periods, run.unsolved_by_second);
  return run;
}

namespace {

void add_secular(const NoisyRun& noisy, std::vector<PaperNumber>& numbers) {
  numbers.push_back({"secular ψp - ψm before the noise begins", "Sec. VI", "~1e-8",
                     noisy.secular_by_rk4.steady, noisy.secular.steady, "",
                     "the paper's: RK4 less eq. 16; ours: the return map less the same "
                     "equation. RK4's own phase error is -6.8e-9"});
  numbers.push_back({"secular ψp - ψm under the noise", "Sec. VI", "~1e-8",
                     noisy.secular_by_rk4.noisy, noisy.secular.noisy, "",
                     fmt::format("fitted from where the noise begins. The noise adds {:.1f}e-9: "
                                 "second order goes as the square of the torque, whose mean is 9 % "
                                 "more",
                                 1e9 * (noisy.secular.noisy - noisy.secular.steady))});
  numbers.push_back(
      {"the same, the model with the circular error of eq. A1", "Sec. VI", "", not_known,
       noisy.secular_in_full.noisy, "",
       "nearer by chance: eq. A1 adds λ⁴/384 = +1.6e-8, but a free swing has -3λ⁴/1024 beyond "
       "-λ²/16; the budget has what outweighs it"});
  numbers.push_back({"the same, the model of second order", "Sec. VI", "", not_known,
                     noisy.secular_by_second.noisy, "",
                     "the secular difference is the O1 and O2 of eqs. 15 and 16, with the "
                     "noise and without: closed, third order is left"});
}

} // namespace

void add_long_run(const NoisyRun& noisy, std::vector<PaperNumber>& numbers) {
  constexpr double year_s = 365.25 * seconds_per_day;
  const double exact = exact_rate(point_c());
  const double rk4 = rk4_rate(point_c(), Rk4Torque::per_stage);
  numbers.push_back({"steps of 0.03 in a nominal period", "Sec. V", "~209", two_pi / step,
                     two_pi / step, "", "none"});
  numbers.push_back({"nominal periods in 1e9 steps", "Sec. VI", "~4.8e6", 1e9 * step / two_pi,
                     1e9 * step / two_pi, "", "none"});
  numbers.push_back({"the same at 2 s", "Sec. VI", "about 110 days",
                     1e9 * step / pi / seconds_per_day, 1e9 * step / pi / seconds_per_day, "d",
                     "none"});
  numbers.push_back({"gain at C without variability", "Sec. VI", "1e-8", rk4, exact, "",
                     "RK4's own phase error is -6.8e-9; the budget below has the rest"});
  numbers.push_back({"the same in a year", "Sec. VI", "0.3 s/yr", year_s * rk4, year_s * exact,
                     "s/yr", "the same"});
  add_secular(noisy, numbers);
}

std::vector<PaperFigure> long_run_figures(const NoisyRun& noisy) {
  const std::vector<Marker> begins{{0.1 * noisy.periods.back(), "noise begins"}};
  const auto line = [&](const char* label, const std::vector<double>& y, int colour) {
    return Series{Series::Style::line, label, noisy.periods, y, {}, {}, colour};
  };
  return {{"quasistat_gain",
           {"quasistat_gain",
            "Pendulum time less laboratory time at C",
            "The drive varies by 30 % from period to period right of the line.",
            {"time", "nominal periods"},
            {"ψp - t", "rad"},
            {line("RK4, dt = 0.03", noisy.by_rk4, green), line("return map", noisy.gained, blue)},
            begins}},
          {"quasistat_model",
           {"quasistat_model",
            "Pendulum time less that of the averaged equations at C",
            "The noise is followed; what first order lacks adds up steadily, with the noise by a "
            "little less. Second order leaves nothing that is seen here.",
            {"time", "nominal periods"},
            {"ψp - ψm", "rad"},
            {line("RK4 less eq. 16", noisy.unsolved_by_rk4, green),
             line("return map less eq. 16", noisy.unsolved, blue),
             line("the same, the circular error by eq. A1", noisy.unsolved_in_full, vermilion),
             line("return map less second order", noisy.unsolved_by_second, purple)},
            begins}}};
}

} // namespace goingrate::paper

#include "paper_figures.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/dynamics/moments.hpp"
#include "goingrate/dynamics/operating_point.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <numbers>

namespace goingrate::paper {

namespace {

using std::numbers::pi;

constexpr int blue = 0, vermilion = 1, green = 2, purple = 3;

std::shared_ptr<const std::vector<double>> noisy_drive(const PaperOptions& options,
                                                       std::uint64_t seed) {
  auto factors =
      std::make_shared<std::vector<double>>(static_cast<std::size_t>(options.periods), 1.0);
  RandomStream random(seed, StreamPurpose::fast_drive);
  constexpr double rms = 0.3;
  for (std::size_t i = factors->size() / 10; i < factors->size(); ++i)
    (*factors)[i] = 1.0 + rms * random.normal();
  return factors;
}

Scenario noisy_scenario(const PaperOptions& options, Method method,
                        const std::shared_ptr<const std::vector<double>>& factors) {
  Scenario scenario;
  scenario.clock = point_c();
  scenario.periods = options.periods;
  scenario.method.method = method;
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

// By how much the noise changed the mean rate of a run.
double gain_by_noise(const PaperOptions& options, std::uint64_t seed) {
  ClockRun run(noisy_scenario(options, Method::map, noisy_drive(options, seed)), seed);
  const double T0 = point_c().nominal_period_s;
  double at_start = 0.0, last = 0.0;
  while (const auto period = run.next()) {
    last = gain_of(*period, T0);
    if (period->cycle == options.periods / 10) at_start = last;
  }
  const double scaled = two_pi * 0.9 * static_cast<double>(options.periods);
  return (last - at_start) / scaled - limit_cycle(point_c())->rate_excess;
}

double slope(const std::vector<double>& x, const std::vector<double>& y) {
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

} // namespace

Scenario jump_scenario(std::int64_t periods, Method method) {
  Scenario scenario;
  scenario.clock = point_a();
  scenario.periods = periods;
  scenario.method.method = method;
  ClockEvent event;
  event.at_period = 150;
  event.mu = point_b().mu;
  scenario.events = {event};
  return scenario;
}

NoisyRun noisy_run(const PaperOptions& options) {
  const auto factors = noisy_drive(options, options.seed);
  ClockRun pendulum(noisy_scenario(options, Method::map, factors), 0);
  ClockRun model(noisy_scenario(options, Method::averaged1, factors), 0);
  const double T0 = point_c().nominal_period_s;
  NoisyRun run;
  constexpr std::int64_t every = 500; // as in the paper
  double beyond = 0.0;                // phase by what eq. ce3 has beyond -lambda^2/16
  while (const auto period = pendulum.next()) {
    const auto modelled = model.next();
    if (!modelled) break;
    const double lambda = modelled->velocity;
    beyond += two_pi * (circular_error(lambda) + lambda * lambda / 16.0);
    if (period->cycle % every != 0) continue;
    const double gained = gain_of(*period, T0);
    run.periods.push_back(static_cast<double>(period->cycle));
    run.gained.push_back(gained);
    run.unsolved_in_full.push_back(gained - gain_of(*modelled, T0));
    run.unsolved.push_back(run.unsolved_in_full.back() + beyond);
  }
  run.noisy_periods = 0.9 * static_cast<double>(options.periods);
  run.secular = slope(run.periods, run.unsolved) / two_pi;
  run.secular_in_full = slope(run.periods, run.unsolved_in_full) / two_pi;
  constexpr int runs = 16;
  double sum = 0.0, sum2 = 0.0;
  for (int k = 0; k < runs; ++k) {
    const double gain = gain_by_noise(options, options.seed + 1 + static_cast<std::uint64_t>(k));
    sum += gain / runs;
    sum2 += gain * gain;
  }
  run.mean_gain = sum;
  run.rms_gain = std::sqrt((sum2 - runs * sum * sum) / (runs - 1));
  return run;
}

namespace {

// Where the clock's rate is `rate`: for every friction up to two torques, joined at the fold.
Series contour(double s_per_day, int colour) {
  Series line{Series::Style::line, fmt::format("{:+.0f} s/day", s_per_day), {}, {}, {}, {}, colour};
  std::vector<std::pair<double, double>> lower, upper;
  for (double epsilon = 5e-6; epsilon <= 5e-4; epsilon *= 1.005) {
    KnownPair known;
    known.epsilon = epsilon;
    known.rate_excess = s_per_day / seconds_per_day;
    const auto points = operating_points(known, 0.03, Equations::first_order);
    if (points.empty()) continue;
    upper.emplace_back(epsilon, points.back().mu);
    if (points.size() > 1) lower.emplace_back(epsilon, points.front().mu);
  }
  std::reverse(lower.begin(), lower.end());
  lower.insert(lower.end(), upper.begin(), upper.end());
  constexpr double most = 5e-5; // the drawing's edge
  for (const auto& [epsilon, mu] : lower) {
    line.x.push_back(epsilon);
    line.y.push_back(mu <= most ? mu : std::nan(""));
  }
  return line;
}

Figure rate_figure() {
  Figure figure{"rate",
                "Stationary rate over friction and torque",
                "Lines of equal rate by eq. statrate, phi0 = 0.03. Below the lowest straight line "
                "the clock stalls; A, B, C are the paper's points.",
                {"friction epsilon", ""},
                {"torque mu", ""},
                {}};
  for (const double rate : {-20.0, -10.0, -5.0})
    figure.series.push_back(contour(rate, blue));
  figure.series.push_back(contour(0.0, vermilion));
  for (const double rate : {5.0, 10.0, 17.0})
    figure.series.push_back(contour(rate, green));
  for (const double times : {1.0, 2.0, 3.0}) {
    Series line{
        Series::Style::line, fmt::format("lambda = {:.0f} phi0", times), {}, {}, {}, {}, purple};
    for (const double epsilon : {0.0, 5e-4}) {
      const double mu = 0.5 * pi * epsilon * 0.03 * times * times;
      const double reach = std::min(1.0, mu > 0.0 ? 5e-5 / mu : 1.0);
      line.x.push_back(epsilon * reach);
      line.y.push_back(mu * reach);
    }
    figure.series.push_back(std::move(line));
  }
  figure.series.push_back({Series::Style::points,
                           "A, B, C",
                           {point_c().epsilon, point_a().epsilon, point_b().epsilon},
                           {point_c().mu, point_a().mu, point_b().mu},
                           {},
                           {},
                           4});
  return figure;
}

// The angle between crossings as the eye sees it: lambda sin psi, the amplitude of each period.
Figure zoom_figure() {
  Figure figure{"jump_zoom",
                "The angle around the jump of the torque",
                "From A to B at cycle 150: the eye sees nothing.",
                {"time", "nominal periods"},
                {"angle", "rad"},
                {}};
  Series line{Series::Style::line, "angle", {}, {}, {}, {}, blue};
  ClockRun run(jump_scenario(154, Method::direct), 0);
  double begin = 0.0;
  const double T0 = point_a().nominal_period_s;
  while (const auto period = run.next()) {
    if (period->cycle > 146)
      for (int k = 0; k < 60; ++k) {
        const double share = k / 60.0;
        line.x.push_back((begin + share * period->period_s) / T0);
        line.y.push_back(period->velocity * std::sin(two_pi * share));
      }
    begin = period->time_s.value();
  }
  figure.series = {std::move(line)};
  figure.markers = {{150.0, "jump"}};
  return figure;
}

struct JumpCourse {
  std::vector<double> time, rate, amplitude;
};

JumpCourse course_of(Scenario scenario) {
  ClockRun run(scenario, 0);
  JumpCourse course;
  const double T0 = scenario.clock.nominal_period_s;
  while (const auto period = run.next()) {
    course.time.push_back(period->time_s.value() / T0);
    course.rate.push_back(period->rate_excess);
    course.amplitude.push_back(period->velocity);
  }
  return course;
}

std::vector<PaperFigure> jump_figures() {
  Scenario paper = jump_scenario(1600, Method::rk4);
  paper.method.rk4_torque = Rk4Torque::per_stage;
  const JumpCourse rk4 = course_of(paper);
  const JumpCourse exact = course_of(jump_scenario(1600, Method::direct));
  const JumpCourse theory = course_of(jump_scenario(1600, Method::averaged1));
  Series diamonds{Series::Style::points, "theory, eq. dotpsi4", {}, {}, {}, {}, vermilion};
  for (std::size_t i = 100; i < theory.time.size(); i += 150) {
    diamonds.x.push_back(theory.time[i]);
    diamonds.y.push_back(theory.rate[i]);
  }
  Figure rate{
      "jump_rate",
      "The rate after a jump of the torque",
      "The rate jumps at once and tapers off as the amplitude grows. RK4's noise is that of "
      "its interpolated crossings.",
      {"time", "nominal periods"},
      {"rate excess", ""},
      {{Series::Style::line, "RK4, dt = 0.03", rk4.time, rk4.rate, {}, {}, green},
       {Series::Style::line, "full equation", exact.time, exact.rate, {}, {}, blue},
       diamonds},
      {{150.0, "jump"}}};
  Figure amplitude{
      "jump_amplitude",
      "The amplitude after a jump of the torque",
      "It takes many small pushes to change the energy.",
      {"time", "nominal periods"},
      {"amplitude", "rad"},
      {{Series::Style::line, "full equation", exact.time, exact.amplitude, {}, {}, blue}},
      {{150.0, "jump"}}};
  return {{"jump_rate", std::move(rate)}, {"jump_amplitude", std::move(amplitude)}};
}

} // namespace

std::vector<PaperFigure> figures(const NoisyRun& noisy) {
  std::vector<PaperFigure> all{{"rate", rate_figure()}, {"jump_zoom", zoom_figure()}};
  for (PaperFigure& figure : jump_figures())
    all.push_back(std::move(figure));
  const double starts = 0.1 / 0.9 * noisy.noisy_periods;
  all.push_back({"quasistat_gain",
                 {"quasistat_gain",
                  "Pendulum time less laboratory time at C",
                  "The drive varies by 30 % from period to period right of the line.",
                  {"time", "nominal periods"},
                  {"psi_p - t", "rad"},
                  {{Series::Style::line, "gain", noisy.periods, noisy.gained, {}, {}, blue}},
                  {{starts, "noise begins"}}}});
  all.push_back(
      {"quasistat_model",
       {"quasistat_model",
        "Pendulum time less that of the averaged equations at C",
        "What first order lacks adds up steadily; the noise is followed.",
        {"time", "nominal periods"},
        {"psi_p - psi_m", "rad"},
        {{Series::Style::line, "eq. dotpsi4", noisy.periods, noisy.unsolved, {}, {}, blue},
         {Series::Style::line,
          "with the circular error of eq. ce3",
          noisy.periods,
          noisy.unsolved_in_full,
          {},
          {},
          vermilion}},
        {{starts, "noise begins"}}}});
  return all;
}

} // namespace goingrate::paper

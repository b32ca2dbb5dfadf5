#include "paper_figures.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/base/thread_clock.hpp"
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

namespace {

constexpr std::int64_t plotted_every = 500; // as in the paper

// psi - t at every 500th crossing, and the CPU time that took; `each` sees every period.
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

} // namespace

NoisyRun noisy_run(const PaperOptions& options) {
  const auto factors = noisy_drive(options, options.seed);
  const auto nothing = [](const Period&) {};
  NoisyRun run;
  run.by_rk4 = gains(noisy_scenario(options, Method::rk4, factors), options,
                     "fig. quasistat by RK4, as the paper did", run.rk4_s, nothing);
  run.gained = gains(noisy_scenario(options, Method::map, factors), options,
                     "the same by the return map", run.map_s, nothing);
  double beyond = 0.0; // phase by what eq. ce3 has beyond -lambda^2/16
  std::vector<double> beyond_there;
  const auto model =
      gains(noisy_scenario(options, Method::averaged1, factors), options,
            "the same by the averaged equations", run.model_s, [&](const Period& period) {
              const double lambda = period.velocity;
              beyond += two_pi * (circular_error(lambda) + lambda * lambda / 16.0);
              if (period.cycle % plotted_every == 0) beyond_there.push_back(-beyond);
            });
  run.unsolved_in_full = difference(run.gained, model);
  run.unsolved = difference(run.unsolved_in_full, beyond_there);
  run.unsolved_by_rk4 = difference(difference(run.by_rk4, model), beyond_there);
  for (std::size_t i = 0; i < run.unsolved_in_full.size(); ++i)
    run.periods.push_back(static_cast<double>(plotted_every) * static_cast<double>(i + 1));
  run.secular = slope(run.periods, run.unsolved) / two_pi;
  run.secular_by_rk4 = slope(run.periods, run.unsolved_by_rk4) / two_pi;
  run.secular_in_full = slope(run.periods, run.unsolved_in_full) / two_pi;
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
                "Lines of equal rate by eq. statrate, φ0 = 0.03. Below the lowest straight line "
                "the clock stalls; A, B, C are the paper's points.",
                {"friction ε", ""},
                {"torque μ", ""},
                {}};
  for (const double rate : {-20.0, -10.0, -5.0})
    figure.series.push_back(contour(rate, blue));
  figure.series.push_back(contour(0.0, vermilion));
  for (const double rate : {5.0, 10.0, 17.0})
    figure.series.push_back(contour(rate, green));
  for (const double times : {1.0, 2.0, 3.0}) {
    Series line{
        Series::Style::line, fmt::format("λ = {:.0f} φ0", times), {}, {}, {}, {}, purple};
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

// The angle between two crossings by the equation of motion: classical Runge-Kutta in steps of a
// hundredth of a period from the velocity that direct integration has at the first.
void add_swing(const ClockParameters& clock, double velocity, double begin, Series& line) {
  constexpr int steps = 100;
  constexpr double h = two_pi / steps;
  double angle = 0.0, speed = velocity, direction = 1.0;
  const auto acceleration = [&](double phi, double w) {
    return direction * clock.mu - 2.0 * clock.epsilon * w - std::sin(phi);
  };
  for (int k = 0; k < steps; ++k) {
    line.x.push_back(begin + static_cast<double>(k) / steps);
    line.y.push_back(angle);
    const double a1 = acceleration(angle, speed), w2 = speed + 0.5 * h * a1;
    const double a2 = acceleration(angle + 0.5 * h * speed, w2), w3 = speed + 0.5 * h * a2;
    const double a3 = acceleration(angle + 0.5 * h * w2, w3), w4 = speed + h * a3;
    const double a4 = acceleration(angle + h * w3, w4);
    angle += h / 6.0 * (speed + 2.0 * (w2 + w3) + w4);
    speed += h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4);
    if (direction * angle >= clock.phi0) direction = -direction;
  }
}

Figure zoom_figure() {
  Figure figure{"jump_zoom",
                "The angle around the jump of the torque",
                "From A to B at cycle 150, by the equation of motion: the eye sees nothing.",
                {"time", "nominal periods"},
                {"angle", "rad"},
                {}};
  Series line{Series::Style::line, "angle", {}, {}, {}, {}, blue};
  ClockRun run(jump_scenario(154, Method::direct), 0);
  const double T0 = point_a().nominal_period_s;
  Period before = run.last();
  while (const auto period = run.next()) {
    if (period->cycle > 146)
      add_swing(before.cycle < 150 ? point_a() : point_b(), before.velocity,
                before.time_s.value() / T0, line);
    before = *period;
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
  // lambda^2 goes from that of A to that of B as exp(-2 eps t): eq. l2jump, t scaled.
  Series jump{Series::Style::points, "theory, eq. l2jump", {}, {}, {}, {}, vermilion};
  const double a2 = std::pow(*stationary_amplitude(point_a()), 2),
               b2 = std::pow(*stationary_amplitude(point_b()), 2);
  for (double t = 0.0; t < 1600.0; t += 100.0) {
    const double gone = std::exp(-2.0 * point_a().epsilon * two_pi * std::max(0.0, t - 150.0));
    jump.x.push_back(t);
    jump.y.push_back(std::sqrt(b2 + (a2 - b2) * gone));
  }
  Figure amplitude{
      "jump_amplitude",
      "The amplitude after a jump of the torque",
      "It takes many small pushes to change the energy. The full equation's amplitude is φ' at "
      "the crossings, the theory's a cycle's mean.",
      {"time", "nominal periods"},
      {"amplitude", "rad"},
      {{Series::Style::line, "full equation", exact.time, exact.amplitude, {}, {}, blue}, jump},
      {{150.0, "jump"}}};
  return {{"jump_rate", std::move(rate)}, {"jump_amplitude", std::move(amplitude)}};
}

} // namespace

std::vector<PaperFigure> figures(const NoisyRun& noisy) {
  std::vector<PaperFigure> all{{"rate", rate_figure()}, {"jump_zoom", zoom_figure()}};
  for (PaperFigure& figure : jump_figures())
    all.push_back(std::move(figure));
  const double starts = 0.1 * noisy.periods.back();
  all.push_back(
      {"quasistat_gain",
       {"quasistat_gain",
        "Pendulum time less laboratory time at C",
        "The drive varies by 30 % from period to period right of the line.",
        {"time", "nominal periods"},
        {"psi_p - t", "rad"},
        {{Series::Style::line, "RK4, dt = 0.03", noisy.periods, noisy.by_rk4, {}, {}, green},
         {Series::Style::line, "return map", noisy.periods, noisy.gained, {}, {}, blue}},
        {{starts, "noise begins"}}}});
  all.push_back({"quasistat_model",
                 {"quasistat_model",
                  "Pendulum time less that of the averaged equations at C",
                  "What first order lacks adds up steadily; the noise is followed.",
                  {"time", "nominal periods"},
                  {"psi_p - psi_m", "rad"},
                  {{Series::Style::line,
                    "RK4 less eq. dotpsi4",
                    noisy.periods,
                    noisy.unsolved_by_rk4,
                    {},
                    {},
                    green},
                   {Series::Style::line,
                    "return map less eq. dotpsi4",
                    noisy.periods,
                    noisy.unsolved,
                    {},
                    {},
                    blue},
                   {Series::Style::line,
                    "the same, the circular error by eq. ce3",
                    noisy.periods,
                    noisy.unsolved_in_full,
                    {},
                    {},
                    vermilion}},
                  {{starts, "noise begins"}}}});
  return all;
}

} // namespace goingrate::paper

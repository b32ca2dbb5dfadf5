// Sudden changes, sec. such: the jump of the torque from A to B, figs. jump_zoom and jump, and of the
// friction, which the paper tells in words.
#include "paper_rates.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/dynamics/averaged_pendulum.hpp"
#include "goingrate/dynamics/moments.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace goingrate::paper {

namespace {

using std::numbers::pi;

constexpr std::int64_t jumps_at = 150;

// A with half its friction: it swings as wide as B in the end.
ClockParameters with_less_friction() {
  ClockParameters clock = point_a();
  clock.epsilon *= 0.5;
  return clock;
}

// From A to another clock.
Scenario jump_scenario(const ClockParameters& after, std::int64_t periods, Method method) {
  Scenario scenario = scenario_of(point_a(), periods, method);
  ClockEvent event;
  event.at_period = jumps_at;
  event.mu = after.mu;
  event.epsilon = after.epsilon;
  scenario.events = {event};
  return scenario;
}

/// For each period: when it ends, in nominal periods, its rate, and the amplitude at its end.
struct JumpCourse {
  std::vector<double> time, rate, amplitude;
};

JumpCourse course_of(const Scenario& scenario) {
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

// The course by eqs. dotl4 and dotpsi4 of the paper, with the circular error -lambda^2/16.
JumpCourse course_by_paper(const ClockParameters& after, std::int64_t periods) {
  AveragedPendulum pendulum(point_a(), *stationary_amplitude(point_a()), AveragedOrder::first);
  JumpCourse course;
  TwoPart<double> beyond; // excess over the nominal periods, scaled
  for (std::int64_t i = 0; i < periods; ++i) {
    if (i == jumps_at) pendulum.set_clock(after);
    const double excess = pendulum.advance().excess;
    beyond += excess;
    course.time.push_back(static_cast<double>(i + 1) + beyond.value() / two_pi);
    course.rate.push_back(rate_excess_of(excess));
    course.amplitude.push_back(pendulum.velocity());
  }
  return course;
}

// The area between the rate after the jump and the final rate, as a phase.
double phase_gained(const JumpCourse& course) {
  const double cycles = static_cast<double>(course.time.size()) - jumps_at;
  const double took = course.time.back() - course.time[jumps_at - 1];
  return two_pi * (cycles - (1.0 + course.rate.back()) * took);
}

// The angle between two crossings by the equation of motion: classical Runge-Kutta in steps of a
// hundredth of a period, from the velocity that direct integration gives at the first crossing.
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
  ClockRun run(jump_scenario(point_b(), jumps_at + 4, Method::direct), 0);
  const double T0 = point_a().nominal_period_s;
  Period before = run.last();
  while (const auto period = run.next()) {
    if (period->cycle > jumps_at - 4)
      add_swing(before.cycle < jumps_at ? point_a() : point_b(), before.velocity,
                before.time_s.value() / T0, line);
    before = *period;
  }
  figure.series = {std::move(line)};
  figure.markers = {{static_cast<double>(jumps_at), "jump"}};
  return figure;
}

constexpr std::int64_t drawn_periods = 1600; // periods

// Of each curve the points at which the paper's figure has diamonds.
Series diamonds_of(const JumpCourse& theory) {
  Series diamonds{Series::Style::points, "theory, eq. 16", {}, {}, {}, {}, vermilion};
  for (std::size_t i = 100; i < theory.time.size(); i += 150) {
    diamonds.x.push_back(theory.time[i]);
    diamonds.y.push_back(theory.rate[i]);
  }
  return diamonds;
}

Figure rate_figure(const JumpCourse& exact, const JumpCourse& theory) {
  Scenario scenario = jump_scenario(point_b(), drawn_periods, Method::rk4);
  scenario.method.rk4_torque = Rk4Torque::per_stage;
  const JumpCourse rk4 = course_of(scenario);
  return {"jump_rate",
          "The rate after a jump of the torque",
          "The rate jumps at once and tapers off as the amplitude grows. RK4's noise is that of "
          "its switches, displaced within their steps, and of its interpolated crossings.",
          {"time", "nominal periods"},
          {"rate excess", ""},
          {{Series::Style::line, "RK4, dt = 0.03", rk4.time, rk4.rate, {}, {}, green},
           {Series::Style::line, "full equation", exact.time, exact.rate, {}, {}, blue},
           diamonds_of(theory)},
          {{static_cast<double>(jumps_at), "jump"}}};
}

Figure friction_figure() {
  const JumpCourse exact =
      course_of(jump_scenario(with_less_friction(), drawn_periods, Method::direct));
  return {"jump_friction",
          "The rate after the friction has halved",
          "At A, which then swings as wide as B. No jerk: the rate follows the amplitude, half as "
          "fast as after the jump of the torque.",
          {"time", "nominal periods"},
          {"rate excess", ""},
          {{Series::Style::line, "full equation", exact.time, exact.rate, {}, {}, blue},
           diamonds_of(course_by_paper(with_less_friction(), drawn_periods))},
          {{static_cast<double>(jumps_at), "friction halved"}}};
}

// What the first period after a change shows of the whole change of the rate.
double shown_at_once(const JumpCourse& course) {
  const double before = course.rate[jumps_at - 1];
  return (course.rate[jumps_at] - before) / (course.rate.back() - before);
}

// The periods after the change until the rate has gone half of its way for good.
double half_way(const JumpCourse& course) {
  const double middle = 0.5 * (course.rate[jumps_at - 1] + course.rate.back());
  const bool rises = course.rate.back() > middle;
  std::size_t i = course.rate.size();
  while (i > 0 && (course.rate[i - 1] > middle) == rises)
    --i;
  return static_cast<double>(i) - jumps_at;
}

// lambda^2 goes from A's value to B's as exp(-2 eps t), t scaled: eq. l2jump.
double amplitude_by_l2jump(double periods) {
  const double a2 = std::pow(*stationary_amplitude(point_a()), 2),
               b2 = std::pow(*stationary_amplitude(point_b()), 2);
  return std::sqrt(b2 + (a2 - b2) * std::exp(-2.0 * point_a().epsilon * two_pi * periods));
}

Figure amplitude_figure(const JumpCourse& exact) {
  Series jump{Series::Style::points, "theory, eq. 18", {}, {}, {}, {}, vermilion};
  for (double t = 0.0; t < drawn_periods; t += 100.0) {
    jump.x.push_back(t);
    jump.y.push_back(amplitude_by_l2jump(std::max(0.0, t - jumps_at)));
  }
  return {"jump_amplitude",
          "The amplitude after a jump of the torque",
          "It takes many small pushes to change the energy. The full equation's amplitude is φ' at "
          "the crossings, the theory's a cycle's mean.",
          {"time", "nominal periods"},
          {"amplitude", "rad"},
          {{Series::Style::line, "full equation", exact.time, exact.amplitude, {}, {}, blue}, jump},
          {{static_cast<double>(jumps_at), "jump"}}};
}

} // namespace

namespace {

constexpr std::int64_t settled_periods = 40'000; // periods: 60 relaxation times of half A's friction

void add_friction_jump(const JumpCourse& torque_jump, const JumpCourse& by_paper_of_torque,
                       std::vector<PaperNumber>& numbers) {
  const JumpCourse exact =
      course_of(jump_scenario(with_less_friction(), settled_periods, Method::direct));
  const JumpCourse averaged = course_by_paper(with_less_friction(), settled_periods);
  numbers.push_back({"share of its change that the rate shows in the first period after the torque "
                     "jumps from A to B",
                     "Sec. V", "at once", shown_at_once(by_paper_of_torque),
                     shown_at_once(torque_jump), "", "second order"});
  numbers.push_back({"the same, the friction of A halved", "Sec. V", "no sudden jerk",
                     shown_at_once(averaged), shown_at_once(exact), "",
                     "what λ grows in half a period; friction's own part is of second order"});
  numbers.push_back({"periods until the rate has gone half of that way", "Sec. V", "slowly, like λ",
                     half_way(averaged), half_way(exact), "", "none: counted in whole periods"});
}

} // namespace

void add_jump(std::vector<PaperNumber>& numbers) {
  const ClockParameters a = point_a(), b = point_b();
  const double lambda = *stationary_amplitude(a);
  const double cosine = std::sqrt(1.0 - std::pow(a.phi0 / lambda, 2));
  const JumpCourse exact = course_of(jump_scenario(b, settled_periods, Method::direct));
  const JumpCourse averaged = course_by_paper(b, settled_periods);
  const double by_paper = phase_gained(averaged), ours = phase_gained(exact);
  const double at_once = first_order_rate(a) + 2.0 * (b.mu - a.mu) * cosine / (pi * lambda);
  numbers.push_back({"rate just after the jump from A to B", "Sec. V", "3.2e-4", at_once,
                     exact.rate[jumps_at], "",
                     fmt::format("second order; λ grows in this period already, but that makes "
                                 "{:.0f}e-9 of it only",
                                 1e9 * (averaged.rate[jumps_at] - at_once))});
  numbers.push_back({"relative growth of λ in that period", "Sec. V", "",
                     averaged.amplitude[jumps_at] / lambda - 1.0,
                     exact.amplitude[jumps_at] / exact.amplitude[jumps_at - 1] - 1.0, "",
                     "a cycle's mean against φ' at the crossing"});
  constexpr std::size_t later = 300; // periods after the jump
  numbers.push_back({"λ 300 periods after the jump", "Sec. III C", "eqs. 17, 18",
                     amplitude_by_l2jump(static_cast<double>(later)),
                     exact.amplitude[jumps_at + later - 1], "rad",
                     "a cycle's mean against φ' at the crossing"});
  numbers.push_back(
      {"phase gained after the jump", "Sec. V", "0.295", by_paper, ours, "rad", "second order"});
  numbers.push_back({"the same for a 1 m pendulum", "Sec. V", "~0.1 s", by_paper / pi, ours / pi,
                     "s", "second order"});
  add_friction_jump(exact, averaged, numbers);
}

std::vector<PaperFigure> jump_figures() {
  const JumpCourse exact = course_of(jump_scenario(point_b(), drawn_periods, Method::direct));
  return {{"jump_zoom", zoom_figure()},
          {"jump_rate", rate_figure(exact, course_by_paper(point_b(), drawn_periods))},
          {"jump_amplitude", amplitude_figure(exact)},
          {"jump_friction", friction_figure()}};
}

} // namespace goingrate::paper

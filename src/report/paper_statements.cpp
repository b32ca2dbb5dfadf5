// What the paper states in words, measured.
#include "paper_figures.hpp"
#include "paper_rates.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/dynamics/custom_pendulum.hpp"
#include "goingrate/dynamics/moments.hpp"
#include "goingrate/dynamics/operating_point.hpp"

#include <cmath>
#include <numbers>

namespace goingrate::paper {

namespace {

using std::numbers::pi;

// Two clocks that the averaged equations cannot tell apart.
double rate_of_equal_impulse() {
  const ClockParameters c = point_c();
  const double lambda = *stationary_amplitude(c);
  const DriveMoments moments = drive_moments(c, lambda);
  ClockParameters impulse = c;
  impulse.escapement = Escapement::single_impulse;
  impulse.impulse = 2.0 * pi * lambda * moments.a;
  impulse.impulse_angle = lambda * std::sin(std::atan(moments.b / moments.a));
  return exact_rate(impulse);
}

// By a torque as large as C's that goes as cos 2 psi, whose moments a and b are 0.
double rate_with_harmonic(double size) {
  const ClockParameters c = point_c();
  const double lambda2 = std::pow(*stationary_amplitude(c), 2);
  const auto torque = [=](double phi, double w) {
    const bool helps_right = w > 0.0 ? phi < c.phi0 : phi < -c.phi0;
    return (helps_right ? c.mu : -c.mu) + size * (w * w - phi * phi) / lambda2;
  };
  const auto friction = [=](double, double w) { return 2.0 * c.epsilon * w; };
  CustomPendulum pendulum({torque, friction, {-c.phi0, c.phi0}, true}, limit_cycle(c)->velocity);
  constexpr int settling = 6000, counted = 2000; // periods; the swing relaxes in 700
  double excess = 0.0;
  for (int i = 0; i < settling + counted; ++i) {
    const double one = pendulum.advance().excess;
    if (i >= settling) excess += one / counted;
  }
  return rate_excess_of(excess);
}

// How the rate of C follows a length that grows steadily: per relative change of it.
double rate_per_length() {
  Scenario scenario = scenario_of(point_c(), 20'000, Method::direct);
  const double before = ClockRun(scenario, 0).start_velocity();
  scenario.start_amplitude = before;
  const auto end = [&] {
    ClockRun run(scenario, 0);
    while (run.next()) {
    }
    return run.last().time_s.value();
  };
  const double steady = end();
  scenario.length.drift_per_day = 1e-4;
  const double mean_change = 0.5 * scenario.length.drift_per_day * steady / seconds_per_day;
  return (steady / end() - 1.0) / mean_change;
}

} // namespace

void add_statements(std::vector<PaperNumber>& numbers) {
  const ClockParameters c = point_c();
  ClockParameters impulse = c;
  impulse.escapement = Escapement::single_impulse;
  impulse.impulse = 4.0 * c.mu * c.phi0; // the energy of C's torque in a period
  impulse.impulse_angle = 0.01;
  numbers.push_back({"rate with a single impulse of the same energy at 0.01 rad", "app. appblow",
                     "-e/(32 π ε) - ε tan ψ1", first_order_rate(impulse),
                     exact_rate(impulse), "", "second order"});
  numbers.push_back({"rate with a single impulse that has C's moments", "sec. rateq", "that of C",
                     first_order_rate(c), rate_of_equal_impulse(), "",
                     "equal moments keep equal time to first order; where in the swing the torque "
                     "acts shows in the second"});
  const double plain = rate_with_harmonic(0.0);
  numbers.push_back({"what a torque of μ cos 2 ψ adds to the rate", "sec. rateq", "nothing", 0.0,
                     rate_with_harmonic(c.mu) - plain, "",
                     "harmonics other than the first have no moments; second order is left"});
  numbers.push_back({"change of the rate per relative change of length", "sec. disc", "-1/2", -0.5,
                     rate_per_length(), "",
                     "the length grows by 46 ppm during the run: its square"});
  const double width = 0.01, lambda = *stationary_amplitude(c);
  numbers.push_back({"escapement error of a push 0.01 rad wide, over ε", "sec. optdriv",
                     "~ δψ = 0.2",
                     escapement_error(c.epsilon, lambda, 0.0, width) / c.epsilon,
                     escapement_error(c.epsilon, lambda, 0.5 * width, width) / c.epsilon, "",
                     "centred it is 0 whatever the width, ours begins at the vertical: the place "
                     "counts, not the width"});
  ClockParameters stronger = c;
  stronger.mu *= 1.3;
  numbers.push_back({"change of the rate by 30 % more torque, over ε", "sec. oomest",
                     "at most about 1",
                     (first_order_rate(stronger) - first_order_rate(c)) / c.epsilon,
                     (exact_rate(stronger) - exact_rate(c)) / c.epsilon, "", "second order"});
}

} // namespace goingrate::paper

// Numbers for what the paper states in words.
#include "paper_rates.hpp"
#include "paper_variants.hpp"

#include "goingrate/dynamics/operating_point.hpp"

#include <fmt/format.h>

namespace goingrate::paper {

namespace {

void add_impulse(std::vector<PaperNumber>& numbers) {
  for (const double angle : {-0.01, 0.0, 0.01}) {
    const ClockParameters impulse = single_impulse(1.0, angle);
    numbers.push_back({fmt::format("rate with a single impulse of C's energy at {} rad", angle),
                       "App. C", "-e/(32 π ε) - ε tan ψ1", first_order_rate(impulse),
                       exact_rate(impulse), "", "second order"});
  }
}

void add_same_moments(std::vector<PaperNumber>& numbers) {
  const auto add = [&](const char* what, const ClockParameters& clock) {
    numbers.push_back({what, "Sec. III A", "that of C", first_order_rate(clock), exact_rate(clock),
                       "", "second order, which knows where in the swing the torque acts"});
  };
  add("rate of C, nominal", point_c());
  add("rate with a single impulse that has C's moments", same_moments(0.0));
  add("rate with pushes 0.01 rad wide that have C's moments", same_moments(0.01));
}

void add_harmonics(std::vector<PaperNumber>& numbers) {
  const double plain = exact_rate(point_c());
  const auto add = [&](const char* shape, int n, bool sine) {
    numbers.push_back({fmt::format("what a torque of {} adds to the rate", shape), "Sec. VII",
                       "nothing", 0.0, with_harmonic(n, sine).rate - plain, "",
                       n == 0 ? "it shifts the middle of the swing: of order μ² = 2e-10"
                              : "its moments are 0; second order is left, (μ/λ)² = 9e-8"});
  };
  add("μ all the time, n = 0,", 0, false);
  add("μ cos 2ψ", 2, false);
  add("μ sin 2ψ", 2, true);
  add("μ cos 3ψ", 3, false);
  add("μ sin 3ψ", 3, true);
}

void add_length(std::vector<PaperNumber>& numbers) {
  constexpr double change = 1e-3;
  const Lengthened longer = lengthened(change), shorter = lengthened(-change);
  numbers.push_back({"change of the rate per relative change of length", "Sec. VII", "-1/2", -0.5,
                     (longer.rate - shorter.rate) / (2.0 * change), "",
                     "0.1 % either way, in gravity over length: the circular and the escapement "
                     "error change as well, by ε of that"});
  numbers.push_back(
      {"relative change of λ per relative change of length", "Sec. VII", "none", 0.0,
       (longer.amplitude - shorter.amplitude) / (2.0 * change * lengthened(0.0).amplitude), "",
       "second order. The largest angle grows by a quarter, φ' at the vertical falls by a quarter; "
       "λ is between them"});
}

void add_pushes(std::vector<PaperNumber>& numbers) {
  const ClockParameters c = point_c();
  const double lambda = *stationary_amplitude(c);
  const auto add = [&](const char* place, double centre, double width) {
    numbers.push_back(
        {fmt::format("escapement error over ε of pushes {} rad wide {}", width, place), "Sec. IV C",
         fmt::format("~ δψ, here {:.2g}", width / lambda),
         escapement_error(c.epsilon, lambda, centre, width) / c.epsilon,
         escapement_error_of(push(centre, width)) / c.epsilon, "",
         "ours is a limit cycle less a free swing as fast at the vertical: second "
         "order. The place counts, not the width"});
  };
  add("with their middle at the vertical", 0.0, 0.002);
  add("with their middle at the vertical", 0.0, 0.01);
  add("with their middle at the vertical", 0.0, 0.06);
  add("that begin at the vertical", 0.005, 0.01);
  add("with their middle 0.015 rad before the vertical", -0.015, 0.002);
  add("with their middle 0.015 rad beyond the vertical", 0.015, 0.002);
}

} // namespace

void add_statements(std::vector<PaperNumber>& numbers) {
  add_impulse(numbers);
  add_same_moments(numbers);
  add_harmonics(numbers);
  add_length(numbers);
  add_pushes(numbers);
  const ClockParameters c = point_c();
  ClockParameters stronger = c;
  stronger.mu *= 1.3;
  numbers.push_back({"change of the rate at C by 30 % more torque, over ε", "Sec. IV B",
                     "at most about 1",
                     (first_order_rate(stronger) - first_order_rate(c)) / c.epsilon,
                     (exact_rate(stronger) - exact_rate(c)) / c.epsilon, "", "second order"});
}

} // namespace goingrate::paper

// What first-order averaging lacks, found by running the full pendulum once.
#include "fit_problem.hpp"

#include "goingrate/dynamics/direct.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>

namespace goingrate::timing_model {

namespace {

// The full pendulum under the fitted parameters, stopping at the cycles of the data.
class Rerun {
public:
  Rerun(const Parameters& parameters, std::span<const double> x)
      : parameters_(parameters), x_(x), pendulum_({}, start(parameters, x, going_)) {
    pendulum_.set_clock(clock());
  }

  // A pendulum at or beyond the top has no swing to follow.
  static bool can_start(const Parameters& parameters, std::span<const double> x) {
    Going<double> going;
    return start(parameters, x, going) < 2.0;
  }

  // Advances to `cycle`; false if the pendulum stops before.
  bool advance_to(double cycle) {
    while (static_cast<double>(cycle_) < cycle) {
      while (event_ < parameters_.event_cycles.size() &&
             static_cast<double>(cycle_) >= parameters_.event_cycles[event_]) {
        apply_changes(parameters_, x_, ++event_, going_);
        pendulum_.set_clock(clock());
      }
      const auto step = pendulum_.advance(direction_);
      if (step.status != SwingStatus::crossed) return false;
      excess_ += step.excess;
      ++cycle_;
    }
    return true;
  }

  [[nodiscard]] double lateness_s(double reference_period_s) const {
    // t - n P = (time - 2 pi n) T0/2pi + n (T0 - P): both brackets are small.
    return excess_.value() * going_.T0 / two_pi +
           static_cast<double>(cycle_) * (going_.T0 - reference_period_s);
  }
  [[nodiscard]] double amplitude() const { return turning_angle_of_velocity(pendulum_.velocity()); }

private:
  // The fit may try a torque below 0, which no clock has: its sign goes into the drive's factor.
  ClockParameters clock() {
    direction_ = going_.mu < 0.0 ? -1.0 : 1.0;
    return {going_.T0, going_.epsilon, std::abs(going_.mu), going_.phi0};
  }

  static double start(const Parameters& parameters, std::span<const double> x,
                      Going<double>& going) {
    apply_changes(parameters, x, 0, going);
    return std::sqrt(going.amplitude2_start);
  }

  const Parameters& parameters_;
  std::span<const double> x_;
  Going<double> going_;
  double direction_ = 1.0;
  DirectPendulum pendulum_;
  TwoPart<double> excess_; // time minus 2 pi a cycle
  std::int64_t cycle_ = 0;
  std::size_t event_ = 0;
};

} // namespace

double limit_cycle_ratio(const Parameters& parameters, std::span<const double> x) {
  Going<double> going;
  apply_changes(parameters, x, 0, going);
  const ClockParameters clock{going.T0, going.epsilon, std::max(0.0, going.mu), going.phi0};
  const auto cycle = limit_cycle(clock);
  return cycle ? cycle->velocity / *stationary_amplitude(clock) : 1.0;
}

std::optional<Correction> difference_to_direct(const FitProblem& problem,
                                               std::span<const double> x) {
  TimingData seen = problem.data; // what a perfect sensor would have logged of the full pendulum
  if (!Rerun::can_start(problem.parameters, x)) return {};
  Rerun rerun(problem.parameters, x);
  Correction correction;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!rerun.advance_to(seen.cycle[i])) return {};
    seen.lateness_s[i] = rerun.lateness_s(seen.reference_period_s);
    seen.elapsed_s[i] = seen.cycle[i] * seen.reference_period_s + seen.lateness_s[i];
    correction.amplitude.push_back(rerun.amplitude());
  }
  Prediction<double> averaged;
  if (!predict(problem.parameters, x, seen, averaged)) return {};
  correction.residual_s = averaged.residual_s;
  for (std::size_t i = 0; i < seen.size(); ++i)
    correction.amplitude[i] -= averaged.amplitude[i];
  return correction;
}

} // namespace goingrate::timing_model

#include "goingrate/dynamics/direct.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/scaled_time.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <cmath>

namespace goingrate {

DirectPendulum::DirectPendulum(double velocity) : v2_{velocity * velocity, 0.0} {
  if (!(velocity > 0.0 && velocity < 2.0))
    throw ArgumentError("velocity", velocity,
                        "above 0 and below 2 (where the pendulum turns over)");
  v2_.lo = std::fma(velocity, velocity, -v2_.hi);
}

DirectPendulum::Step DirectPendulum::advance(double epsilon, double mu, double phi0) {
  Step step;
  for (const bool upward : {true, false}) {
    const auto swing = half_swing(velocity(), epsilon, mu, phi0, helping_);
    step.status = swing.status;
    if (swing.status != SwingStatus::crossed) return step;
    v2_ += swing.speed2_change;
    // The torque that helped and did not switch, or that switched, is seen mirrored from here on.
    helping_ = swing.switched || !helping_;
    step.full += swing.duration;
    if (upward) step.down = step.full;
  }
  return step;
}

double DirectPendulum::velocity() const { return std::sqrt(v2_.value()); }

void DirectPendulum::rescale(double ratio) {
  const double v = velocity() * ratio;
  v2_ = {v * v, std::fma(v, v, -v * v)};
}

namespace {

double start_velocity_of(const Scenario& scenario) {
  if (scenario.start_amplitude) return *scenario.start_amplitude;
  const auto cycle = limit_cycle(scenario.clock);
  if (!cycle)
    throw ArgumentError("start.amplitude", "stationary",
                        "a number: this clock has no stationary swing (it would stall, or has no "
                        "drive or no friction)");
  return cycle->velocity;
}

const Scenario& checked(const Scenario& scenario) {
  check(scenario);
  return scenario;
}

TwoPart<double> in_seconds(const TwoPart<double>& scaled, const TimeScale& scale) {
  TwoPart<double> result{scale.seconds(scaled.hi), 0.0};
  result += scale.seconds(scaled.lo);
  return result;
}

} // namespace

double turning_angle_of_velocity(double velocity) { return 2.0 * std::asin(0.5 * velocity); }

DirectRun::DirectRun(const Scenario& scenario, std::uint64_t seed)
    : scenario_(checked(scenario)), pending_(scenario.events), clock_(scenario.clock),
      drive_(scenario.drive, scenario.clock.nominal_period_s, seed),
      start_velocity_(start_velocity_of(scenario)), pendulum_(start_velocity_) {
  now_.velocity = start_velocity_;
  now_.amplitude_rad = turning_angle_of_velocity(start_velocity_);
}

void DirectRun::apply_due_events() {
  const double nominal_before = clock_.nominal_period_s;
  std::erase_if(pending_, [&](const ClockEvent& event) {
    const bool due =
        event.at_period ? now_.cycle >= *event.at_period : now_.time_s.value() >= *event.at_s;
    if (due) clock_ = event.applied_to(clock_);
    return due;
  });
  if (clock_.nominal_period_s != nominal_before)
    pendulum_.rescale(clock_.nominal_period_s / nominal_before);
}

bool DirectRun::complete() const {
  return scenario_.periods ? now_.cycle >= *scenario_.periods
                           : now_.time_s.value() >= *scenario_.duration_s;
}

std::optional<Period> DirectRun::next() {
  if (status_ != SwingStatus::crossed || complete()) return {};
  apply_due_events();
  now_.mu = clock_.acting_torque() * drive_.next();
  const auto step = pendulum_.advance(clock_.epsilon, now_.mu, clock_.phi0);
  status_ = step.status;
  if (status_ != SwingStatus::crossed) return {};
  const TimeScale scale(clock_.nominal_period_s);
  const auto length = in_seconds(step.full, scale);
  now_.down_s = now_.time_s;
  now_.down_s += in_seconds(step.down, scale);
  now_.time_s += length;
  now_.period_s = length.value();
  now_.rate_excess = rate_excess_of(step.full);
  now_.velocity = pendulum_.velocity();
  now_.amplitude_rad = turning_angle_of_velocity(now_.velocity);
  ++now_.cycle;
  return now_;
}

} // namespace goingrate

#include "goingrate/dynamics/clock_run.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/intermittent.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

FactorRange factor_range(const DriveVariability& drive) {
  FactorRange range;
  if (drive.series) {
    const auto [low, high] = std::minmax_element(drive.series->begin(), drive.series->end());
    range = {*low, *high};
  }
  double spread = 7.0 * std::hypot(drive.fast_rms, drive.slow_rms);
  for (const auto& sine : drive.sines)
    spread += std::abs(sine.amplitude);
  return {range.low - spread, range.high + spread};
}

double drive_strength(const ClockParameters& clock) {
  switch (clock.escapement) {
  case Escapement::constant_torque:
    return clock.mu;
  case Escapement::single_impulse:
    return clock.impulse;
  case Escapement::profile:
    return 1.0;
  case Escapement::none:
    break;
  }
  return 0.0;
}

namespace {

const Scenario& checked(const Scenario& scenario) {
  check(scenario);
  return scenario;
}

double start_velocity_of(const Scenario& scenario, Method method) {
  if (scenario.start_amplitude) return *scenario.start_amplitude;
  // Each kind of equations has a stationary swing of its own.
  const auto velocity = stationary_start(scenario.clock, method == Method::averaged1);
  if (!velocity)
    throw NoStationarySwing("start.amplitude", "stationary",
                            "a number: this clock has no stationary swing (it would stall, or has "
                            "no drive or no friction)");
  return *velocity;
}

} // namespace

ClockRun::Pendulum ClockRun::make_pendulum(const Scenario& scenario, const MethodChoice& choice,
                                           double velocity, MapDigits digits) {
  const bool halves = scenario.sensor.edges != SensorEdges::up;
  switch (choice.method) {
  case Method::map: {
    MapPendulum map(scenario.clock, velocity, factor_range(scenario.drive), digits);
    map.find_halves(halves);
    return map;
  }
  case Method::averaged1:
  case Method::averaged2: {
    if (halves && !scenario.clock.is_plain())
      throw ArgumentError("run.method", name_of(choice.method),
                          "direct or map: the averaged equations do not know when this escapement "
                          "crosses downwards, and the sensor reports both directions");
    const auto order =
        choice.method == Method::averaged2 ? AveragedOrder::second : AveragedOrder::first_in_full;
    return AveragedPendulum(scenario.clock, velocity, order);
  }
  case Method::rk4:
    return Rk4Clock(scenario.clock, velocity, scenario.method.dt, scenario.method.rk4_torque);
  case Method::direct:
  case Method::automatic:
    break;
  }
  return DirectPendulum(scenario.clock, velocity);
}

ClockRun::ClockRun(const Scenario& scenario, std::uint64_t seed, MapDigits digits)
    : scenario_(checked(scenario)), choice_(choose_method(scenario)), pending_(scenario.events),
      clock_(scenario.clock), period_now_s_(scenario.clock.nominal_period_s),
      drive_(scenario.drive, scenario.clock.nominal_period_s, seed),
      start_velocity_(start_velocity_of(scenario, choice_.method)),
      pendulum_(make_pendulum(scenario, choice_, start_velocity_, digits)) {
  now_.velocity = start_velocity_;
  now_.nominal_period_s = period_now_s_;
  now_.amplitude_rad = turning_angle_of_velocity(scenario.clock.gravity_share, start_velocity_);
  in_parts_ = action_parts(clock_).has_value();
}

std::int64_t ClockRun::fallbacks() const {
  const auto* map = std::get_if<MapPendulum>(&pendulum_);
  return map == nullptr ? 0 : map->fallbacks();
}

void ClockRun::apply_due_changes() {
  const ClockParameters before = clock_;
  bool due_any = false;
  std::erase_if(pending_, [&](const ClockEvent& event) {
    const bool due =
        event.at_period ? now_.cycle >= *event.at_period : now_.time_s.value() >= *event.at_s;
    if (due) clock_ = event.applied_to(clock_);
    due_any = due_any || due;
    return due;
  });
  if (due_any) {
    ClockParameters same_period = clock_;
    same_period.nominal_period_s = before.nominal_period_s;
    if (!(same_period == before)) {
      std::visit([&](auto& pendulum) { pendulum.set_clock(clock_); }, pendulum_);
      in_parts_ = action_parts(clock_).has_value();
    }
  }
  double period_s = clock_.nominal_period_s;
  if (!scenario_.length.none())
    period_s *= std::sqrt(1.0 + scenario_.length_change_at(now_.time_s.value()));
  if (period_s != period_now_s_)
    std::visit([&](auto& pendulum) { pendulum.rescale(period_s / period_now_s_); }, pendulum_);
  period_now_s_ = period_s;
}

bool ClockRun::complete() const {
  return scenario_.periods ? now_.cycle >= *scenario_.periods
                           : now_.time_s.value() >= *scenario_.duration_s;
}

std::optional<Period> ClockRun::next() {
  if (status_ != SwingStatus::crossed || complete()) return {};
  if (!pending_.empty() || !scenario_.length.none()) apply_due_changes();
  let_in_ = escapement_acts(clock_, now_.cycle, now_.velocity, in_parts_ && let_in_);
  const double factor = drive_.next(now_.time_s.hi) * (let_in_ ? 1.0 : 0.0);
  const PeriodStep step =
      std::visit([&](auto& pendulum) { return pendulum.advance(factor); }, pendulum_);
  status_ = step.status;
  if (status_ != SwingStatus::crossed) return {};
  const TimeScale scale(period_now_s_);
  now_.mu = drive_strength(clock_) * factor;
  now_.nominal_period_s = period_now_s_;
  now_.down_s = now_.time_s;
  now_.down_s += scale.half_nominal();
  now_.down_s += scale.seconds(step.half_excess);
  now_.time_s += scale.nominal();
  now_.time_s += scale.seconds(step.excess);
  now_.period_s = scale.nominal().hi + scale.seconds(step.excess);
  now_.rate_excess = rate_excess_of(step.excess);
  now_.velocity = std::visit([](const auto& pendulum) { return pendulum.velocity(); }, pendulum_);
  now_.amplitude_rad = turning_angle_of_velocity(clock_.gravity_share, now_.velocity);
  ++now_.cycle;
  return now_;
}

} // namespace goingrate

#include "reference_run.hpp"

#include "clock_model.hpp"
#include "cycle_response.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>

namespace goingrate::timing_model {

namespace {

// A clock's parameters in the form that the dynamics take.
ClockParameters clock_of(double T0, const AveragedLaws<double>& laws) {
  ClockParameters clock;
  clock.nominal_period_s = T0;
  clock.epsilon = laws.epsilon;
  clock.escapement = laws.escapement;
  clock.quadratic_drag = laws.quadratic;
  clock.dry_friction = laws.dry;
  clock.gravity_share = 16.0 * laws.circular;
  const bool impulse = clock.escapement == Escapement::single_impulse;
  (impulse ? clock.impulse : clock.mu) = laws.mu;
  (impulse ? clock.impulse_angle : clock.phi0) = laws.phi0;
  return clock;
}
ClockParameters clock_of(const Going<double>& going) { return clock_of(going.T0, going.laws); }

ClockEvent change_to(const ClockParameters& clock, double cycle) {
  ClockEvent event;
  event.at_period = static_cast<std::int64_t>(cycle);
  event.nominal_period_s = clock.nominal_period_s;
  event.epsilon = clock.epsilon;
  if (clock.escapement == Escapement::single_impulse) {
    event.impulse = clock.impulse;
    event.impulse_angle = clock.impulse_angle;
  } else if (clock.escapement != Escapement::none) {
    event.mu = clock.mu;
    event.phi0 = clock.phi0;
  }
  return event;
}

Scenario scenario_of(FitDynamics dynamics, const FitProblem& problem, std::span<const double> x) {
  Going<double> going;
  if (problem.parameters.escapement == Escapement::none) going.laws.phi0 = untouchable_angle;
  apply_changes(problem.parameters, x, 0, going);
  Scenario scenario;
  scenario.clock = clock_of(going);
  scenario.start_amplitude = std::sqrt(going.amplitude2_start);
  scenario.periods = static_cast<std::int64_t>(problem.data->cycle.back());
  constexpr std::int64_t most_direct_periods = 500; // periods: for more, its patches pay off
  scenario.method.method = dynamics == FitDynamics::averaged2 ? Method::averaged2
                           : *scenario.periods > most_direct_periods  ? Method::map
                                                              : Method::direct;
  for (std::size_t k = 0; k < problem.parameters.event_cycles.size(); ++k) {
    apply_changes(problem.parameters, x, k + 1, going);
    scenario.events.push_back(change_to(clock_of(going), problem.parameters.event_cycles[k]));
  }
  return scenario;
}

// Runs one clock after the other; each repeats its last period once it has settled.
class SettlingRun {
public:
  SettlingRun(const Scenario& scenario, double reference_period_s, double memories)
      : scenario_(scenario), events_(scenario.events), reference_period_s_(reference_period_s),
        memories_(memories) {
    scenario_.events.clear();
    begin();
  }

  // False if the clock stops before.
  bool advance_to(double cycle) {
    while (passed_ < events_.size() && cycle > date_of(passed_)) {
      if (!go_to(date_of(passed_))) return false;
      change();
    }
    return go_to(cycle);
  }
  [[nodiscard]] double late_s() const {
    const Period& last = run_->last();
    const auto cycle = static_cast<double>(last.cycle);
    const double late = std::fma(-cycle, reference_period_s_, last.time_s.hi) + last.time_s.lo;
    return late_at_begin_s_ + late + beyond_ * (last.period_s - reference_period_s_);
  }
  [[nodiscard]] double amplitude() const { return run_->last().amplitude_rad; }
  [[nodiscard]] double speed2() const { return std::pow(run_->last().velocity, 2); }

private:
  [[nodiscard]] double date_of(std::size_t event) const {
    return static_cast<double>(*events_[event].at_period);
  }
  void begin() {
    run_.emplace(scenario_, 0, MapDigits::of_a_double);
    // The amplitude comes to rest at rate 2 epsilon.
    settled_ = 1.0 + std::ceil(memories_ / (2.0 * two_pi * scenario_.clock.epsilon));
    beyond_ = 0.0;
  }
  bool go_to(double cycle) {
    const double until = std::min(cycle - begun_, settled_);
    while (static_cast<double>(run_->last().cycle) < until)
      if (!run_->next()) return false;
    beyond_ = cycle - begun_ - static_cast<double>(run_->last().cycle);
    return true;
  }
  void change() {
    const ClockParameters next = events_[passed_].applied_to(scenario_.clock);
    late_at_begin_s_ = late_s();
    begun_ = date_of(passed_);
    // phi' is by time in units of T0 / 2 pi.
    scenario_.start_amplitude =
        run_->last().velocity * next.nominal_period_s / scenario_.clock.nominal_period_s;
    scenario_.clock = next;
    ++passed_;
    begin();
  }

  Scenario scenario_;
  std::vector<ClockEvent> events_;
  std::optional<ClockRun> run_;
  double reference_period_s_;
  double memories_;        // in units of 1/2 epsilon, until a clock has settled
  std::size_t passed_ = 0; // events
  double begun_ = 0.0;     // cycle
  double late_at_begin_s_ = 0.0;
  double settled_ = 0.0; // cycles after the beginning
  double beyond_ = 0.0;  // cycles
};

// The responses along a course that crosses with these speeds; new ones whenever the clock changes.
class ResponseAlong {
public:
  ResponseAlong(const std::vector<double>& speed2, bool leaves_its_course) : speed2_(speed2) {
    if (speed2.empty()) return;
    const auto [least, greatest] = std::minmax_element(speed2.begin(), speed2.end());
    // The range of speeds that the clock reaches at three sigma with a slow drive of one fifth.
    least_ = *least * (leaves_its_course ? 0.3 : 1.0);
    greatest_ = *greatest * (leaves_its_course ? 2.0 : 1.0);
  }

  void add(std::size_t beat, const Sight<double>& sight) {
    if (clocks_->empty() || sight.T0 != T0_ || *sight.laws != laws_) {
      T0_ = sight.T0;
      laws_ = *sight.laws;
      clocks_->emplace_back(clock_of(T0_, laws_), laws_, least_, greatest_,
                            sight.amplitude2 - speed2_[beat]);
    }
    const CycleResponses& clock = clocks_->back();
    at_.push_back({&clock, speed2_[beat], speed2_[beat] + clock.offset() - sight.amplitude2});
  }
  void put_into(Correction& correction) {
    correction.clocks = clocks_;
    correction.responses = std::move(at_);
  }

private:
  const std::vector<double>& speed2_;
  double least_ = 0.0, greatest_ = 0.0;
  double T0_ = 0.0;
  AveragedLaws<double> laws_;
  std::shared_ptr<std::deque<CycleResponses>> clocks_ =
      std::make_shared<std::deque<CycleResponses>>();
  std::vector<ResponseAt> at_;
};

} // namespace

double limit_cycle_ratio(const Parameters& parameters, std::span<const double> x) {
  Going<double> going;
  if (parameters.escapement == Escapement::none) return 1.0;
  apply_changes(parameters, x, 0, going);
  const ClockParameters clock = clock_of(going);
  const auto cycle = limit_cycle(clock);
  const auto amplitude = stationary_amplitude(clock);
  return cycle && amplitude ? cycle->velocity / *amplitude : 1.0;
}

namespace {

// In units of 1/2 epsilon: how long a clock runs until it is taken for settled.
constexpr double memories_below_rounding = 40.0;
constexpr double memories_below_slopes = 16.0; // 1e-7 of the approach remains

std::optional<Correction> difference(FitDynamics dynamics, const FitProblem& problem,
                                     std::span<const double> x, double memories,
                                     bool with_responses) {
  TimingData seen = problem.asked(); // what a perfect sensor would have logged of that clock
  Correction correction;
  std::vector<double> speed2;
  try {
    SettlingRun run(scenario_of(dynamics, problem, x), seen.reference_period_s, memories);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (!run.advance_to(seen.cycle[i])) return {};
      seen.lateness_s[i] = run.late_s();
      seen.elapsed_s[i] = seen.cycle[i] * seen.reference_period_s + seen.lateness_s[i];
      correction.amplitude.push_back(run.amplitude());
      speed2.push_back(run.speed2());
    }
  } catch (const ArgumentError&) { // a start beyond the top, laws that averaged2 does not know
    return {};
  }
  // A perfect sensor, nothing from outside, and changes at crossings, as in the run.
  Parameters bare = problem.parameters;
  std::erase_if(bare.slots, [](const Slot& slot) {
    return slot.quantity == Quantity::offset || slot.quantity == Quantity::term ||
           is_of_moment(slot.quantity);
  });
  const bool disturbed =
      with_responses && (bare.has(Quantity::drive_rms) || bare.has(Quantity::slow_rms));
  ResponseAlong responses(speed2, seen.has_amplitude()); // without amplitudes, the filter has none
  const bool holds = Follower<double>(bare, x, seen).run([&](std::size_t i, const auto& sight) {
    correction.late_s.push_back(sight.late_s);
    correction.amplitude[i] -= sight.laws->turning_angle(sight.amplitude2);
    if (disturbed) responses.add(i, sight);
  });
  if (disturbed) responses.put_into(correction);
  return holds ? std::optional(std::move(correction)) : std::nullopt;
}

} // namespace

std::optional<Correction> difference_to(FitDynamics dynamics, const FitProblem& problem,
                                        std::span<const double> x) {
  return difference(dynamics, problem, x, memories_below_rounding, true);
}

std::optional<Correction::Slopes>
slopes_of_difference(FitDynamics dynamics, const FitProblem& problem, std::span<const double> x) {
  constexpr double step = 1e-5; // of a coordinate: rounding and curvature are both below 1e-4 of it
  const auto run = [&](std::span<const double> place) {
    return difference(dynamics, problem, place, memories_below_slopes, false);
  };
  const auto here = run(x);
  if (!here) return {};
  Correction::Slopes slopes;
  slopes.at.assign(x.begin(), x.end());
  const auto quotient = [](const std::vector<double>& there, const std::vector<double>& base) {
    std::vector<double> slope;
    for (std::size_t i = 0; i < there.size(); ++i)
      slope.push_back((there[i] - base[i]) / step);
    return slope;
  };
  for (const Slot& slot : problem.parameters.slots) {
    if (!slot.free || is_noise(slot.quantity)) continue;
    if (slot.index != slopes.late_s.size()) return {}; // those of the noise come last
    std::vector<double> beside = slopes.at;
    beside[slot.index] += step;
    const auto there = run(beside);
    if (!there) return {};
    slopes.late_s.push_back(quotient(there->late_s, here->late_s));
    slopes.amplitude.push_back(quotient(there->amplitude, here->amplitude));
  }
  return slopes;
}

} // namespace goingrate::timing_model

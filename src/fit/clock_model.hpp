// The averaged clock as a function of its parameters: the times at which it should have crossed,
// and its amplitude there. Private to the fit room.
#pragma once

#include "course.hpp"
#include "parameters.hpp"
#include "within_cycle.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

namespace goingrate::timing_model {

inline constexpr double untouchable_angle = 1e-9; ///< of a pendulum without an escapement

/// The parameters now in force, and the state of the clock when they came into force.
template <class T> struct Going {
  T T0{};
  AveragedLaws<T> laws{};
  T amplitude2_start{};
  T cycle{};  ///< at which they came into force, not always a whole number
  T late_s{}; ///< time at which the clock reached it, minus cycle * reference period
};

template <class T>
void apply_changes(const Parameters& parameters, std::span<const T> x, std::size_t event,
                   Going<T>& going) {
  going.laws.escapement = parameters.escapement;
  going.laws.linear =
      !parameters.has(Quantity::quadratic_drag) && !parameters.has(Quantity::dry_friction);
  for (const Slot& slot : parameters.slots) {
    if (slot.event != event) continue;
    switch (slot.quantity) {
    case Quantity::T0:
      going.T0 = slot.value(x);
      break;
    case Quantity::epsilon:
      going.laws.epsilon = slot.value(x);
      break;
    case Quantity::mu:
      going.laws.mu = slot.value(x);
      break;
    case Quantity::phi0:
      going.laws.phi0 = slot.value(x);
      break;
    case Quantity::quadratic_drag:
      going.laws.quadratic = slot.value(x);
      break;
    case Quantity::dry_friction:
      going.laws.dry = slot.value(x);
      break;
    case Quantity::gravity_share:
      going.laws.circular = slot.value(x) * (1.0 / 16.0);
      break;
    case Quantity::lambda0: {
      const T lambda0 = slot.value(x);
      going.amplitude2_start = lambda0 * lambda0;
      break;
    }
    default:
      break; // not a parameter of the clock
    }
  }
}

/// The model's prediction for one beat.
template <class T> struct Sight {
  T late_s{};     ///< t_i minus the model's time: (psi(t_i) - 2 pi n_i) T0 / (2 pi psi')
  T amplitude2{}; ///< x
  T T0{};
  const AveragedLaws<T>* laws = nullptr;
  bool settled = false;
};

/// Follows the clock along `data` and calls see(i, sight) at every beat; false if the model does
/// not hold (the amplitude falls to the escapement angle, or is not finite).
template <class T> class Follower {
public:
  Follower(const Parameters& parameters, std::span<const T> x, const TimingData& data)
      : parameters_(parameters), x_(x), data_(data) {
    if (parameters.escapement == Escapement::none) going_.laws.phi0 = T(untouchable_angle);
    apply_changes(parameters, x, 0, going_);
    going_.amplitude2_start /= parameters.start_ratio * parameters.start_ratio;
    for (const Slot& slot : parameters.slots) {
      if (slot.quantity == Quantity::offset) offset_ = slot.value(x);
      if (slot.quantity == Quantity::term) terms_.push_back({slot.term, slot.value(x)});
    }
    has_offset_ = parameters.has(Quantity::offset);
  }

  template <class See> bool run(See&& see) {
    using std::isfinite;
    if (!going_.laws.reaches(going_.amplitude2_start)) return false;
    Course<T> course(going_.laws, going_.amplitude2_start);
    std::size_t event = 0;
    double next = next_change(event);
    for (std::size_t i = 0; i < data_.size(); ++i) {
      for (; data_.cycle[i] > next; next = next_change(event))
        if (!pass_event(++event, course)) return false;
      const T t = (data_.elapsed_s[i] - going_.cycle * data_.reference_period_s - going_.late_s) *
                  (two_pi / going_.T0);
      const auto state = course.at(t);
      if (!state) return false;
      const Sight<T> sight{late(i, *state), state->amplitude2, going_.T0, &course.laws(),
                           course.settled()};
      if (!isfinite(sight.late_s) || !isfinite(sight.amplitude2)) return false;
      see(i, sight);
    }
    return true;
  }

private:
  struct Term {
    std::size_t which;
    T coefficient;
  };

  // A lateness in phase becomes one in time on division by the rate. Without the division a model
  // that runs slow would shrink the noise, and be preferred for it.
  T late(std::size_t i, const typename Course<T>::State& state) const {
    using std::asin, std::sqrt;
    const T longer = going_.T0 - data_.reference_period_s;
    T value = (data_.lateness_s[i] - going_.late_s - (data_.cycle[i] - going_.cycle) * longer +
               going_.T0 * state.phase_excess * (1.0 / two_pi)) /
              (state.rate + 1.0);
    if (has_offset_) {
      // The speed at the vertical is lambda (1 - s lambda^2/64), from A = lambda (1 + 5 s
      // lambda^2/192).
      const T slower = state.amplitude2 * going_.laws.circular * -0.25 + 1.0;
      value -= asin(offset_ / (sqrt(state.amplitude2) * slower)) * going_.T0 * (1.0 / two_pi);
    }
    for (const Term& term : terms_)
      value += term.coefficient * data_.terms[term.which].advance_s[i];
    return value;
  }

  // The parameter for the moment of an event; 0 if the event came at a crossing.
  [[nodiscard]] T at_event(Quantity quantity, std::size_t event) const {
    const Slot* slot = parameters_.find(quantity, event);
    return slot == nullptr ? T(0.0) : slot->value(x_);
  }
  // The cycle of the change that comes after `event`.
  [[nodiscard]] double next_change(std::size_t event) const {
    if (event >= parameters_.event_cycles.size()) return std::numeric_limits<double>::infinity();
    return parameters_.event_cycles[event] + plain(at_event(Quantity::moment, event + 1));
  }

  // Lets the clock run to the event and applies its changes. The rate is nearly constant, so each
  // of Newton's steps gains eight digits, in the derivatives too.
  bool pass_event(std::size_t event, Course<T>& course) {
    const T moment = at_event(Quantity::moment, event);
    const T cycles = parameters_.event_cycles[event - 1] - going_.cycle + moment;
    T t = cycles * two_pi;
    for (int round = 0; round < 3; ++round) {
      const auto state = course.at(t);
      if (!state) return false;
      t -= (t + state->phase_excess - cycles * two_pi) / (state->rate + 1.0);
    }
    const auto state = course.at(t);
    if (!state) return false;
    going_.late_s += cycles * (going_.T0 - data_.reference_period_s) -
                     going_.T0 * state->phase_excess * (1.0 / two_pi);
    going_.cycle += cycles;
    const Going<T> before = going_;
    apply_changes(parameters_, x_, event, going_);
    going_.late_s += at_event(Quantity::late_leap, event);
    const T leap = at_event(Quantity::amplitude_leap, event) + 1.0;
    return begin(before, sqrt_of(state->amplitude2) * leap, moment, course);
  }

  // Begins a course with the laws now in force, from the present place of the clock and
  // `amplitude`.
  bool begin(const Going<T>& before, const T& amplitude, const T& moment, Course<T>& course) {
    const Leap<T> leap =
        leap_between(before.laws, going_.laws, amplitude, moment, T(going_.T0 / before.T0));
    const T grown = amplitude + leap.amplitude;
    going_.amplitude2_start = grown * grown;
    going_.late_s -= going_.T0 * leap.phase * (1.0 / two_pi);
    if (!going_.laws.reaches(going_.amplitude2_start)) return false;
    course = Course<T>(going_.laws, going_.amplitude2_start);
    return true;
  }
  static T sqrt_of(const T& value) {
    using std::sqrt;
    return sqrt(value);
  }

  const Parameters& parameters_;
  std::span<const T> x_;
  const TimingData& data_;
  Going<T> going_;
  T offset_{};
  bool has_offset_ = false;
  std::vector<Term> terms_;
};

} // namespace goingrate::timing_model

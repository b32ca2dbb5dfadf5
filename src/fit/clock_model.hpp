// The averaged clock as a function of its parameters: when it should have crossed, and how large it
// swung. Private to the fit room.
//
// Equations (Hoyng, eqs. dotl4, dotpsi4, blow5; moments.hpp), x = lambda^2, scaled time, relative
// drive d:
//   dx/dt    = f = -2 eps x + (1 + d) D - (8/3pi) k x^(3/2) - (4/pi) c x^(1/2)
//   psi' - 1 = g = -x/16 + (1 + d) push(x)
// constant torque:  D = 4 mu phi0/pi,  push = (2 mu/pi) y/x,  y = sqrt(x - phi0^2);
// single impulse:   D = e/pi,          push = -(e/2pi x) phi1/y,  y = sqrt(x - phi1^2).
// With constant torque and linear friction both are integrated in closed form
// (dynamics/averaged.hpp), otherwise by Runge-Kutta steps that are short beside the relaxation.
#pragma once

#include "parameters.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/dynamics/averaged.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// The value of a number that may carry derivatives.
inline double plain(double value) { return value; }
template <class T> double plain(const T& value) { return value.a; }

/// The laws of a clock while its parameters are constant, as right sides of the averaged equations.
template <class T> struct AveragedLaws {
  Escapement escapement = Escapement::constant_torque;
  bool linear = true; ///< friction has no other term, not even one that is 0 at present
  T epsilon{}, mu{}, phi0{}, quadratic{}, dry{};

  [[nodiscard]] bool closed() const { return escapement != Escapement::single_impulse && linear; }
  [[nodiscard]] T drive() const {
    return escapement == Escapement::single_impulse ? T(mu * (1.0 / std::numbers::pi))
                                                    : T(mu * phi0 * (4.0 / std::numbers::pi));
  }
  [[nodiscard]] T growth(const T& x) const {
    using std::sqrt;
    T f = drive() - epsilon * x * 2.0;
    if (!linear) {
      const T lambda = sqrt(x);
      f -= (quadratic * x * (2.0 / 3.0) + dry) * lambda * (4.0 / std::numbers::pi);
    }
    return f;
  }
  [[nodiscard]] T growth_slope(const T& x) const {
    using std::sqrt;
    T slope = epsilon * -2.0;
    if (!linear) {
      const T lambda = sqrt(x);
      slope -= (quadratic * lambda + dry / lambda * 0.5) * (4.0 / std::numbers::pi);
    }
    return slope;
  }
  [[nodiscard]] T push(const T& x) const {
    using std::sqrt;
    const T y = sqrt(x - phi0 * phi0);
    return escapement == Escapement::single_impulse
               ? T(mu * phi0 / (x * y) * (-0.5 / std::numbers::pi))
               : T(mu * y / x * (2.0 / std::numbers::pi));
  }
  [[nodiscard]] T push_slope(const T& x) const {
    using std::sqrt;
    const T y2 = x - phi0 * phi0;
    const T y = sqrt(y2);
    if (escapement == Escapement::single_impulse)
      return mu * phi0 / (x * y) * (T(1.0) / x + T(0.5) / y2) * (0.5 / std::numbers::pi);
    return mu / (x * y) * (T(0.5) - y2 / x) * (2.0 / std::numbers::pi);
  }
  [[nodiscard]] T rate(const T& x) const { return push(x) - x * (1.0 / 16.0); }
  /// Whether the averaged equations hold at x: the swing passes the escapement.
  [[nodiscard]] bool reaches(const T& x) const {
    return plain(x) > plain(phi0) * plain(phi0) && plain(x) < 4.0;
  }
};

/// Amplitude and phase while the laws are constant, from t = 0 on.
template <class T> class Course {
public:
  struct State {
    T amplitude2{};   ///< x
    T phase_excess{}; ///< psi - t since the start
    T rate{};         ///< psi' - 1
  };

  Course(const AveragedLaws<T>& laws, const T& amplitude2)
      : laws_(laws), closed_(laws.epsilon, acting_torque(laws), laws.phi0, amplitude2),
        reached_{T(0.0), {amplitude2, T(0.0), laws.rate(amplitude2)}, 0.0} {}

  /// The state at t; nothing where the model does not hold.
  [[nodiscard]] std::optional<State> at(const T& t) const {
    if (settled()) return settled_at(reached_, t);
    const auto there = laws_.closed() ? in_closed_form(t) : stepped(t);
    return there ? std::optional(there->state) : std::nullopt;
  }
  /// The same, remembered as the place to go on from.
  std::optional<State> move_to(const T& t) {
    if (settled()) return settled_at(reached_, t);
    auto there = laws_.closed() ? in_closed_form(t) : stepped(t);
    if (!there) return {};
    reached_ = std::move(*there);
    return reached_.state;
  }
  /// Whether amplitude and rate stand still.
  [[nodiscard]] bool settled() const { return stands_still(reached_); }
  [[nodiscard]] const AveragedLaws<T>& laws() const { return laws_; }

private:
  struct Reached {
    T t;
    State state;
    double decay = 0.0; ///< what was left of the way to rest is by exp(decay) shorter
  };

  static T acting_torque(const AveragedLaws<T>& laws) {
    return laws.escapement == Escapement::single_impulse ? T(0.0) : laws.mu;
  }

  // What is left of the way to rest is then below the rounding of a double.
  static bool stands_still(const Reached& reached) { return reached.decay > 45.0; }

  static State settled_at(const Reached& reached, const T& t) {
    const State& from = reached.state;
    return {from.amplitude2, from.phase_excess + from.rate * (t - reached.t), from.rate};
  }

  [[nodiscard]] std::optional<Reached> in_closed_form(const T& t) const {
    const auto state = closed_.at(t);
    if (!closed_.in_domain(state)) return {};
    return Reached{t,
                   {state.amplitude2, state.phase_excess, state.rate_excess},
                   2.0 * plain(laws_.epsilon) * plain(t)};
  }

  // A hundredth of the relaxation, whose error is (1/100)^5/120 of the amplitude, and longer near
  // rest, where only what is left of the way has that error. No derivatives: the course hardly
  // depends on the steps, and continuously, for only the last is cut off.
  [[nodiscard]] double step_at(const T& amplitude2) const {
    constexpr double far = 0.01, longest = 0.5;
    // Below the swing that stalls the motion runs away from it, as fast as it would come to rest.
    const double x = plain(amplitude2), slope = std::abs(plain(laws_.growth_slope(amplitude2)));
    const double growth = std::abs(plain(laws_.growth(amplitude2)));
    const double way = growth / (slope * x); // to rest, in parts of x
    const double part = way < 1.0 ? std::min(longest, far / std::pow(way, 0.2)) : far;
    return part / (growth / x + slope);
  }

  // By Runge-Kutta steps of fourth order.
  [[nodiscard]] std::optional<Reached> stepped(const T& t) const {
    constexpr int most_steps = 1000000;
    Reached at = reached_;
    State& state = at.state;
    for (int step = 0; step < most_steps; ++step) {
      if (stands_still(at)) return Reached{t, settled_at(at, t), at.decay};
      const double left = plain(t) - plain(at.t), whole = step_at(state.amplitude2);
      const bool last = std::abs(left) <= whole;
      const T h = last ? T(t - at.t) : T(std::copysign(whole, left));
      const T &x = state.amplitude2, k1 = laws_.growth(x);
      const T x2 = x + h * k1 * 0.5, k2 = laws_.growth(x2);
      const T x3 = x + h * k2 * 0.5, k3 = laws_.growth(x3);
      const T x4 = x + h * k3, k4 = laws_.growth(x4);
      const T next = x + h * (k1 + (k2 + k3) * 2.0 + k4) * (1.0 / 6.0);
      if (!laws_.reaches(next)) return {};
      const T middle = (x + next) * 0.5 + h * (k1 - k4) * 0.125; // Hermite's cubic
      const T rate = laws_.rate(next);
      state.phase_excess += h * (state.rate + laws_.rate(middle) * 4.0 + rate) * (1.0 / 6.0);
      at.decay -= plain(h) * plain(laws_.growth_slope(middle));
      state.amplitude2 = next;
      state.rate = rate;
      at.t += h;
      if (last) return at;
    }
    return {};
  }

  AveragedLaws<T> laws_;
  AveragedMotion<T> closed_;
  Reached reached_;
};

inline constexpr double untouchable_angle = 1e-9; ///< of a pendulum without an escapement

/// The parameters that hold at present, and where the clock stood when they began to.
template <class T> struct Going {
  T T0{};
  AveragedLaws<T> laws{};
  T amplitude2_start{};
  double cycle = 0.0; ///< at which they began to hold,
  T late_s{};         ///< when the clock came to it, less cycle * reference period
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
    case Quantity::lambda0: {
      const T lambda0 = slot.value(x);
      going.amplitude2_start = lambda0 * lambda0;
      break;
    }
    default:
      break; // not of the clock
    }
  }
}

/// What the model says of one beat.
template <class T> struct Sight {
  T late_s{};     ///< t_i less the model's time: (psi(t_i) - 2 pi n_i) T0 / (2 pi psi')
  T amplitude2{}; ///< x
  T T0{};
  const AveragedLaws<T>* laws = nullptr;
  bool settled = false;
};

/// Follows the clock along `data` and calls see(i, sight) at every beat; false where the model does
/// not hold (the amplitude comes down to the escapement, or is not finite).
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
    for (std::size_t i = 0; i < data_.size(); ++i) {
      while (event < parameters_.event_cycles.size() &&
             data_.cycle[i] > parameters_.event_cycles[event])
        if (!pass_event(++event, course)) return false;
      const T t = (data_.elapsed_s[i] - going_.cycle * data_.reference_period_s - going_.late_s) *
                  (two_pi / going_.T0);
      const auto state = course.move_to(t);
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

  // What is late in phase is late in time by the rate: without the division a model that runs
  // slow would shrink the noise, and be preferred for it.
  T late(std::size_t i, const typename Course<T>::State& state) const {
    using std::asin, std::sqrt;
    const T longer = going_.T0 - data_.reference_period_s;
    T value = (data_.lateness_s[i] - going_.late_s - (data_.cycle[i] - going_.cycle) * longer +
               going_.T0 * state.phase_excess * (1.0 / two_pi)) /
              (state.rate + 1.0);
    if (has_offset_) value -= asin(offset_ / sqrt(state.amplitude2)) * going_.T0 * (1.0 / two_pi);
    for (const Term& term : terms_)
      value += term.coefficient * data_.terms[term.which].advance_s[i];
    return value;
  }

  // Lets the clock run to the event and applies its changes. The rate is nearly constant, so each
  // of Newton's steps gains eight digits, in the derivatives too.
  bool pass_event(std::size_t event, Course<T>& course) {
    const double cycles = parameters_.event_cycles[event - 1] - going_.cycle;
    T t = T(two_pi * cycles);
    for (int round = 0; round < 3; ++round) {
      const auto state = course.at(t);
      if (!state) return false;
      t -= (t + state->phase_excess - two_pi * cycles) / (state->rate + 1.0);
    }
    const auto state = course.move_to(t);
    if (!state) return false;
    going_.late_s += cycles * (going_.T0 - data_.reference_period_s) -
                     going_.T0 * state->phase_excess * (1.0 / two_pi);
    going_.cycle += cycles;
    going_.amplitude2_start = state->amplitude2;
    apply_changes(parameters_, x_, event, going_);
    if (!going_.laws.reaches(going_.amplitude2_start)) return false;
    course = Course<T>(going_.laws, going_.amplitude2_start);
    return true;
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

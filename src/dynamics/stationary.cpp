#include "goingrate/dynamics/stationary.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/sums.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/averaged_pendulum.hpp"
#include "goingrate/dynamics/direct.hpp"
#include "goingrate/dynamics/half_swing.hpp"
#include "goingrate/dynamics/intermittent.hpp"
#include "goingrate/dynamics/moments.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/roots.hpp>
#include <cfloat>
#include <cmath>
#include <limits>
#include <numbers>

namespace goingrate {

using std::numbers::pi;

namespace {

// The largest lambda at which drive and friction balance, for laws without a formula: sought
// downwards from the top (2 rad under gravity), where friction still wins.
std::optional<double> balanced_amplitude(const ClockParameters& clock) {
  const auto gain = [&](double lambda) {
    return drive_moments(clock, lambda).a - friction_moment(clock, lambda);
  };
  constexpr double shrink = 0.97; // finer than any feature of a profile that matters to a clock
  double high = top_velocity(clock.gravity_share);
  if (!(gain(high) <= 0.0)) return {}; // the drive wins up to the top: no swing to rest in
  while (high > 1e-6 && gain(high * shrink) <= 0.0)
    high *= shrink;
  if (high <= 1e-6) return {};
  std::uintmax_t rounds = 60;
  const auto [low, top] = boost::math::tools::bisect(
      gain, high * shrink, high, boost::math::tools::eps_tolerance<double>(50), rounds);
  return 0.5 * (low + top);
}

// The same clock with an escapement that never waits.
ClockParameters acting_always(ClockParameters clock) {
  clock.every = fewest_periods_between_actions(clock);
  clock.below = 0.0;
  return clock;
}

// The mean of an escapement that waits for the amplitude to fall, over the swings between two
// impulses: lambda' = -friction(lambda) from lambda_+ down to the limit.
double waiting_amplitude(const ClockParameters& clock) {
  const double high =
      std::sqrt(clock.below * clock.below + 2.0 * energy_of_period(clock, clock.below));
  using Quadrature = boost::math::quadrature::gauss<double, 20>;
  const auto time = [&](double lambda) { return 1.0 / friction_moment(clock, lambda); };
  const auto squares = [&](double lambda) { return lambda * lambda * time(lambda); };
  return std::sqrt(Quadrature::integrate(squares, clock.below, high) /
                   Quadrature::integrate(time, clock.below, high));
}

} // namespace

std::optional<double> stationary_amplitude(const ClockParameters& clock) {
  if (clock.every > 1)
    return stationary_amplitude(with_drive_divided(clock, static_cast<double>(clock.every)));
  if (clock.below > 0.0) {
    if (!(drive_moments(clock, clock.below).a > 0.0)) return {}; // no push reaches so small a swing
    return waits_for_amplitude(clock) ? waiting_amplitude(clock)
                                      : stationary_amplitude(acting_always(clock));
  }
  if (!clock.is_plain()) return balanced_amplitude(clock);
  const double mu = clock.acting_torque();
  if (mu <= 0.0 || clock.epsilon <= 0.0) return {};
  const double lambda = std::sqrt(2.0 * mu * clock.phi0 / (pi * clock.epsilon));
  if (!(lambda > clock.phi0)) return {};
  return lambda;
}

std::optional<double> stationary_rate_first_order(const ClockParameters& clock) {
  const auto lambda = stationary_amplitude(clock);
  if (!lambda) return {};
  // The share of periods in which the escapement acts, by the energy it has to replace.
  const auto drive = drive_moments(clock, *lambda);
  const double acting = clock.is_intermittent() ? friction_moment(clock, *lambda) / drive.a : 1.0;
  return -clock.gravity_share * *lambda * *lambda / 16.0 - acting * drive.b / *lambda;
}

double rate_excess_of(double period_excess) { return -period_excess / (two_pi + period_excess); }

namespace {

LimitCycle limit_cycle_of(Wide speed2, double period_excess) {
  return {static_cast<double>(std::sqrt(speed2)), period_excess, two_pi + period_excess,
          rate_excess_of(period_excess)};
}

constexpr Wide rounding = std::numeric_limits<Wide>::epsilon();

// A few rounds in 64 bits take the cycle to rounding of the double it is returned in.
std::optional<LimitCycle> polished(const ClockParameters& clock, Wide speed2, Wide slope) {
  RegularPeriod<Wide> period;
  for (int i = 0; i < 4; ++i) {
    period = regular_period<Wide>(clock, speed2, 1.0);
    if (!period.regular) return {};
    const Wide step = period.speed2_change / slope;
    speed2 += step;
    if (std::abs(step) < 10 * rounding * speed2) break;
  }
  return limit_cycle_of(speed2, static_cast<double>(period.excess));
}

// Newton on v^2 with the slope of first order, -2 pi eps per half swing; what the slope lacks is of
// order eps and lambda^2, so every round gains at least two digits.
std::optional<LimitCycle> plain_limit_cycle(const ClockParameters& clock, double start) {
  TwoPart<double> v2{start * start, 0.0};
  const double slope = 2.0 * pi * clock.epsilon;
  constexpr int rounds = 60; // 10 suffice in the paper's region; more near stall and at 2 rad
  HalfSwing<double> swing;
  double step = 0.0, last_step = 0.0;
  for (int i = 0; i < rounds; ++i) {
    swing = half_swing(std::sqrt(v2.value()), clock.epsilon, clock.mu, clock.phi0, true);
    if (swing.status != SwingStatus::crossed || !swing.switched) return {};
    step = swing.speed2_change / slope;
    v2 += step;
    if (!(v2.value() > 0.0)) return {};
    // Rounding: the steps have stopped shrinking, or v would not change.
    const bool settled = std::abs(step) > 0.5 * std::abs(last_step);
    if (std::abs(step) <= (settled ? 1e-14 : 1e-17) * v2.value()) break;
    last_step = step;
  }
  if (std::abs(step) > 1e-12 * v2.value()) return {}; // no fixed point is near: about to stall
  return polished(clock, v2.value(), Wide(2) * slope);
}

// The change of x = v^2 in a cycle of `every` periods that begins with the escapement's action.
template <class Period>
RegularPeriod<Wide> cycle_from(const ClockParameters& clock, Wide x, Period period_at) {
  RegularPeriod<Wide> cycle;
  for (std::int64_t i = 0; i < clock.every; ++i) {
    const auto period = period_at(x + cycle.speed2_change, i);
    if (!period.regular) return {};
    cycle.speed2_change += period.speed2_change;
    cycle.excess += period.excess;
  }
  cycle.excess /= static_cast<Wide>(clock.every);
  cycle.regular = true;
  return cycle;
}

// Secant steps on the whole cycle's change of v^2, for laws whose two halves may differ.
template <class Period>
std::optional<LimitCycle> general_limit_cycle(const ClockParameters& clock, double start,
                                              Wide rounding_of_period, Period period_at) {
  Wide x = static_cast<Wide>(start) * start, x_before = Wide(0), change_before = Wide(0);
  Wide slope = Wide(-1e-2); // a cautious first step; the second has a measured slope
  if (clock.epsilon > 0.0)
    slope = std::expm1(Wide(-4) * pi * clock.epsilon * static_cast<Wide>(clock.every));
  for (int i = 0; i < 100; ++i) {
    const auto period = cycle_from(clock, x, period_at);
    if (!period.regular) return {};
    if (i > 0 && x != x_before) slope = (period.speed2_change - change_before) / (x - x_before);
    if (!(slope < Wide(0))) return {}; // not a cycle that attracts
    x_before = x;
    change_before = period.speed2_change;
    // At most a tenth at a time: a profile's balance may be far from that of its average.
    const Wide step = std::clamp(-period.speed2_change / slope, Wide(-0.1) * x, Wide(0.1) * x);
    if (std::abs(step) <= 100 * rounding_of_period * x)
      return limit_cycle_of(x, static_cast<double>(period.excess));
    x += step;
  }
  return {};
}

// The same for the averaged equations of first order.
std::optional<LimitCycle> averaged_limit_cycle(const ClockParameters& clock, double start) {
  std::optional<AveragedPendulum> pendulum;
  return general_limit_cycle(clock, start, DBL_EPSILON, [&](Wide x, std::int64_t i) {
    if (i == 0)
      pendulum.emplace(clock, std::sqrt(static_cast<double>(x)), AveragedOrder::first_in_full);
    const PeriodStep step = pendulum->advance(i == 0 ? 1.0 : 0.0);
    const Wide after = pendulum->velocity();
    return RegularPeriod<Wide>{step.status == SwingStatus::crossed, after * after - x,
                               Wide(step.half_excess), Wide(step.excess)};
  });
}

} // namespace

std::optional<LimitCycle> limit_cycle(const ClockParameters& clock) {
  if (clock.below > 0.0) {
    if (!stationary_amplitude(clock)) return {};
    if (!waits_for_amplitude(clock)) return limit_cycle(acting_always(clock));
    const auto orbit = waiting_orbit(clock);
    if (!orbit) return {};
    return limit_cycle_of(Wide(orbit->velocity) * orbit->velocity, orbit->period_excess);
  }
  // No limit cycle is looked for if first order would start the search above the top.
  if (!clock.is_plain() || clock.every > 1) {
    const auto start = stationary_amplitude(clock);
    if (!start || !(*start < top_velocity(clock.gravity_share))) return {};
    const auto parts = action_parts(clock);
    return general_limit_cycle(clock, *start, rounding, [&](Wide x, std::int64_t i) {
      if (parts && i < 2) return regular_period<Wide>(i == 0 ? parts->before : parts->after, x, 1);
      return regular_period<Wide>(clock, x, i == 0 ? 1 : 0);
    });
  }
  const double mu = clock.acting_torque();
  if (!(mu > 0.0 && clock.epsilon > 0.0)) return {};
  const double lambda = std::sqrt(2.0 * mu * clock.phi0 / (pi * clock.epsilon));
  // The true stall line lies a little below that of first order: start where the switch is reached.
  const double reaching = 2.0 * std::sin(0.5 * clock.phi0) * 1.001;
  const double start = std::max(lambda, reaching);
  return lambda > 0.8 * clock.phi0 && start < 2.0 ? plain_limit_cycle(clock, start) : std::nullopt;
}

std::optional<double> stationary_start(const ClockParameters& clock, bool averaged) {
  if (clock.below > 0.0) {
    if (!stationary_amplitude(clock)) return {};
    if (waits_for_amplitude(clock))
      return velocity_of_turning_angle(clock.gravity_share, clock.below);
    return stationary_start(acting_always(clock), averaged);
  }
  const auto mean = stationary_amplitude(clock);
  if (averaged && clock.every == 1) return mean;
  const auto cycle = !averaged ? limit_cycle(clock)
                     : mean    ? averaged_limit_cycle(clock, *mean)
                               : std::nullopt;
  if (!cycle) return {};
  return cycle->velocity;
}

std::optional<DriveResponse> drive_response(const ClockParameters& clock) {
  if (!clock.is_plain() || clock.is_intermittent()) return {};
  const auto lambda = stationary_amplitude(clock);
  if (!lambda) return {};
  const double q2 = std::pow(*lambda / clock.phi0, 2);
  DriveResponse response;
  response.fast_gain = clock.epsilon * std::sqrt(q2 - 1.0);
  response.slow_gain = -*lambda * *lambda / 16.0 + clock.epsilon * q2 / (2.0 * std::sqrt(q2 - 1.0));
  response.corner_hz = 2.0 * clock.epsilon / clock.nominal_period_s;
  response.amplitude2 = *lambda * *lambda;
  response.switching_angle = clock.phi0;
  return response;
}

} // namespace goingrate

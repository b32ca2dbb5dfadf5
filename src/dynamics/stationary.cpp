#include "goingrate/dynamics/stationary.hpp"

#include "goingrate/base/scaled_time.hpp"
#include "goingrate/dynamics/half_swing.hpp"

#include <cmath>
#include <numbers>

namespace goingrate {

using std::numbers::pi;

std::optional<double> stationary_amplitude(const ClockParameters& clock) {
  const double mu = clock.acting_torque();
  if (mu <= 0.0 || clock.epsilon <= 0.0) return {};
  const double lambda = std::sqrt(2.0 * mu * clock.phi0 / (pi * clock.epsilon));
  if (!(lambda > clock.phi0)) return {};
  return lambda;
}

std::optional<double> stationary_rate_first_order(const ClockParameters& clock) {
  const auto lambda = stationary_amplitude(clock);
  if (!lambda) return {};
  const double circular = -*lambda * *lambda / 16.0;
  const double escapement =
      clock.epsilon * std::sqrt(2.0 * clock.mu / (pi * clock.epsilon * clock.phi0) - 1.0);
  return circular + escapement;
}

double rate_excess_of(TwoPart<double> period) {
  period += -two_pi;
  period += -two_pi_low;
  const double excess = period.value();
  return -excess / (two_pi + excess);
}

std::optional<LimitCycle> limit_cycle(const ClockParameters& clock) {
  const auto start = stationary_amplitude(clock);
  if (!start || !(*start < 2.0)) return {}; // beyond, first order starts the search over the top
  // Newton on v^2 with the slope of first order, -2 pi eps per half swing; what the slope lacks is
  // of order eps and lambda^2, so every round gains at least two digits.
  TwoPart<double> v2{*start * *start, 0.0};
  const double slope = 2.0 * pi * clock.epsilon;
  constexpr int rounds = 60; // 10 suffice in the paper's region; more near stall and at 2 rad
  HalfSwing<double> swing;
  double step = 0.0;
  for (int i = 0; i < rounds; ++i) {
    swing = half_swing(std::sqrt(v2.value()), clock.epsilon, clock.mu, clock.phi0, true);
    if (swing.status != SwingStatus::crossed || !swing.switched) return {};
    step = swing.speed2_change / slope;
    v2 += step;
    if (!(v2.value() > 0.0)) return {};
    if (std::abs(step) <= 1e-17 * v2.value()) break; // below the rounding of v
  }
  if (std::abs(step) > 1e-13 * v2.value()) return {}; // no fixed point is near: about to stall
  LimitCycle cycle;
  cycle.velocity = std::sqrt(v2.value());
  TwoPart<double> period = swing.duration;
  period += swing.duration;
  cycle.period = period.value();
  cycle.rate_excess = rate_excess_of(period);
  cycle.apex = swing.apex;
  return cycle;
}

std::optional<DriveResponse> drive_response(const ClockParameters& clock) {
  const auto lambda = stationary_amplitude(clock);
  if (!lambda) return {};
  const double q2 = std::pow(*lambda / clock.phi0, 2);
  DriveResponse response;
  response.fast_gain = clock.epsilon * std::sqrt(q2 - 1.0);
  response.slow_gain = -*lambda * *lambda / 16.0 + clock.epsilon * q2 / (2.0 * std::sqrt(q2 - 1.0));
  response.corner_hz = 2.0 * clock.epsilon / clock.nominal_period_s;
  return response;
}

} // namespace goingrate

#include "gain_spread.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace goingrate::timing_model {

namespace {

struct Factors {
  double fast = 1.0, slow = 1.0;
};

// Half of the power of a slow drive lies below this frequency.
double slowest_hz(double memory_s) { return 1.0 / (2.0 * std::numbers::pi * memory_s); }

// Averages over a normal z by the trapezoidal rule, which here converges faster than any power of
// the step.
Factors factors_at(double spread, const DriveResponse& response, double memory_s) {
  constexpr double reach = 5.0, step = 0.1;
  const double x0 = response.amplitude2, phi2 = response.switching_angle * response.switching_angle;
  const double y0 = std::sqrt(x0 - phi2), c = response.fast_gain * x0 / y0;
  double weight = 0.0, gain2 = 0.0, rate = 0.0, rate2 = 0.0;
  for (double z = -reach; z <= reach; z += step) {
    const double w = std::exp(-0.5 * z * z);
    const double x = std::max(phi2, x0 * (1.0 + spread * z)); // below, the clock would stall
    const double y = std::sqrt(x - phi2);
    const double excess = c * (y - y0) / x0 - (x - x0) / 16.0;
    weight += w;
    gain2 += w * std::pow(c * y / x, 2);
    rate += w * excess;
    rate2 += w * excess * excess;
  }
  rate /= weight;
  const double variance = rate2 / weight - rate * rate;
  // What the curvature adds to the rate is compared with the linear response at the corner of the
  // slow drive: where the slow gain is almost zero, it adds far more than that gain does. What it
  // removes, as near a stall, is a share of the slow gain's part.
  const double settled = std::pow(response.slow_gain * spread, 2), added = variance - settled;
  const double linear = std::norm(response.at(slowest_hz(memory_s))) * spread * spread;
  return {gain2 / weight / (response.fast_gain * response.fast_gain),
          added > 0.0 ? 1.0 + added / linear : variance / settled};
}

bool knows_amplitude(const DriveResponse& response) {
  const double phi = response.switching_angle;
  return phi > 0.0 && response.amplitude2 > phi * phi;
}

bool applies(const RateComponents& found, const DriveResponse& response) {
  return knows_amplitude(response) && found.slow2 > 0.0 && std::isfinite(found.slow2);
}

// s_x^2 over s^2.
double share_in_amplitude(const RateComponents& found, const DriveResponse& response) {
  return found.memory_s / (found.memory_s + relaxation_s(response));
}

} // namespace

double relaxation_s(const DriveResponse& response) {
  return 1.0 / (2.0 * std::numbers::pi * response.corner_hz);
}

double amplitude_spread(const RateComponents& drive, const DriveResponse& response) {
  if (!applies(drive, response)) return 0.0;
  return std::sqrt(drive.slow2 * share_in_amplitude(drive, response));
}

double mean_shift(const RateComponents& drive, const DriveResponse& response, double length_s) {
  if (!applies(drive, response)) return 0.0;
  return std::sqrt(drive.slow2 * std::min(1.0, 2.0 * drive.memory_s / length_s));
}

GainDoubt gain_doubt(const DriveResponse& response, double shift, double memory_s) {
  if (!knows_amplitude(response)) return {};
  const double x = response.amplitude2;
  const double y2 = x - response.switching_angle * response.switching_angle;
  // x dg/dx of g_fast = c y/x and of g_slow = c/(2 y) - x0/16: both gains are for a change of the
  // drive relative to mu, not to its mean.
  const double of_fast = response.fast_gain * (0.5 * x / y2 - 1.0);
  const double of_slow = -(response.slow_gain + x / 16.0) * 0.5 * x / y2;
  const DriveResponse change{of_fast, of_slow, response.corner_hz};
  const double hz = memory_s > 0.0 ? slowest_hz(memory_s) : 0.0;
  const double slow = (change.at(hz) / response.at(hz)).real();
  return {std::abs(of_fast / response.fast_gain) * shift, std::abs(slow) * shift};
}

RateComponents with_gains_averaged(RateComponents found, const DriveResponse& response) {
  if (!applies(found, response)) return found;
  const double share = share_in_amplitude(found, response);
  RateComponents drive = found;
  // A smaller spread has no effect; no clock has a larger one.
  constexpr double least_spread = 1e-3, most_spread = 1.0;
  constexpr int rounds = 30; // each gains about one binary digit
  for (int i = 0; i < rounds; ++i) {
    const double spread = std::clamp(std::sqrt(drive.slow2 * share), least_spread, most_spread);
    const Factors factors = factors_at(spread, response, found.memory_s);
    drive.slow2 = 0.5 * (drive.slow2 + found.slow2 / (1.0 + share * (factors.slow - 1.0)));
    drive.fast2 = found.fast2 / factors.fast;
  }
  return drive;
}

} // namespace goingrate::timing_model

#include "push_angle.hpp"

#include "push_friction.hpp"

#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace goingrate::push_shapes {

std::optional<ImpulseCycle::Estimate> angle_of_pushes(const TimingData& data) {
  constexpr double fewest = 3.0; // swings: with two, the kick contains the circular error
  if (!data.impulses || !data.impulses->is_regular || data.impulses->periods < fewest ||
      !data.impulses->amplitude_step)
    return {};
  const ImpulseCycle::Estimate kick = kick_alone(*data.impulses),
                               step = *data.impulses->amplitude_step;
  const double mean = mean_of_known(data.amplitude_rad);
  const auto lambda2 = [](double angle) { return std::pow(2.0 * std::sin(0.5 * angle), 2); };
  const double low2 = lambda2(mean - 0.5 * step.value), high2 = lambda2(mean + 0.5 * step.value);
  const auto later = [&](double angle) {
    const double square = angle * angle;
    return data.reference_period_s / (2.0 * std::numbers::pi) *
           (std::atan2(angle, std::sqrt(low2 - square)) -
            std::atan2(angle, std::sqrt(high2 - square)));
  };
  constexpr double widest = 0.95; // of the swing: beyond, an impulse is hardly one
  const double end = widest * std::sqrt(low2);
  const bool is_possible = low2 > 0.0 && high2 > low2 && std::abs(kick.value) <= later(end);
  if (!is_possible || !(kick.sigma > 0.0)) return {};
  const auto off = [&](double angle) { return later(angle) - kick.value; };
  std::uintmax_t rounds = 60;
  const auto [left, right] = boost::math::tools::bisect(
      off, -end, end, boost::math::tools::eps_tolerance<double>(40), rounds);
  const double angle = 0.5 * (left + right);
  const double nearby = 1e-3 * end; // for a slope, which bends over the whole swing
  const double slope = (later(angle + nearby) - later(angle - nearby)) / (2.0 * nearby);
  return ImpulseCycle::Estimate{angle,
                                std::hypot(kick.sigma / slope, step.sigma / step.value * angle)};
}

} // namespace goingrate::push_shapes

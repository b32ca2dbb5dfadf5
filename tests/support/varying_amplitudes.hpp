// Logs of clocks whose drive wanders, and the slope of their rate against the amplitude.
#pragma once

#include "goingrate/causes/isochronism.hpp"
#include "goingrate/dynamics/stationary.hpp"
#include "support/prior_clocks.hpp"

#include <cmath>
#include <vector>

namespace goingrate::test {

/// How the intervals of the slope fare.
struct SlopeScore {
  int logs = 0, stated = 0, within68 = 0, within95 = 0;
  double z2 = 0.0;
  std::vector<double> relative_sigma; ///< over the true slope

  /// A clock of the prior with a noisy drive and amplitudes, over `longer` times its periods.
  void add(std::uint64_t seed, int longer) {
    DrawnClock drawn = ClockPrior(seed).draw_rough();
    drawn.scenario.periods = longer * drawn.scenario.periods.value();
    drawn.scenario.method.method = Method::map;
    ++logs;
    FitSummary no_fit;
    no_fit.status = FitStatus::no_valid_model;
    const auto beats = simulated_beats(drawn.scenario, seed);
    const auto found = isochronism(timing_data(beats), no_fit);
    if (!found) return;
    const double truth = slope_of(drawn.scenario.clock, found->amplitude_rad);
    const double z = (found->slope - truth) / found->sigma;
    ++stated;
    within68 += std::abs(z) < 0.994458 ? 1 : 0; // quantiles of the normal law
    within95 += std::abs(z) < 1.959964 ? 1 : 0;
    z2 += z * z;
    relative_sigma.push_back(found->sigma / std::abs(truth));
  }

  // From the simulator in stationary operation, with two drives that lead to a little less and a
  // little more than the mean amplitude of the log. The torque shifts the turning angle, too.
  static double slope_of(const ClockParameters& clock, double amplitude) {
    struct Point {
      double amplitude_rad, rate_excess;
    };
    const auto at = [&](double factor) {
      Scenario steady;
      steady.clock = clock;
      steady.clock.mu *= factor * std::pow(amplitude / *stationary_amplitude(clock), 2);
      steady.periods = 4;
      steady.method.method = Method::map;
      steady.sensor.amplitude_rms = 0.0;
      return Point{simulated_log(steady, 1).events.back().amplitude_rad,
                   limit_cycle(steady.clock)->rate_excess};
    };
    constexpr double step = 0.01;
    const Point less = at(1.0 - step), more = at(1.0 + step);
    return (more.rate_excess - less.rate_excess) / (more.amplitude_rad - less.amplitude_rad);
  }
};

} // namespace goingrate::test

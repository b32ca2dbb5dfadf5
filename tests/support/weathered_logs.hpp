// Logs of clocks that respond to the temperature, each with the file of a thermometer.
#pragma once

#include "goingrate/analysis/analyse.hpp"
#include "goingrate/base/random.hpp"

#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <numbers>
#include <string>

namespace goingrate::test {

struct Thermometer {
  const char* name;
  double step_s = 600.0;
  double reading_sigma_k = 0.0; ///< of each reading
  double wander_k = 0.05;       ///< a random walk's step in ten minutes
  bool has_holes = false;       ///< three of 2 h, and none at the beginning
};

inline constexpr std::array<Thermometer, 6> thermometers{
    {{"every minute", 60.0},
     {"every 10 min", 600.0},
     {"every 30 min", 1800.0},
     {"reads to 0.1 K", 600.0, 0.1},
     {"rough air, every 30 min", 1800.0, 0.02, 0.5},
     {"with holes", 600.0, 0.02, 0.05, true}}};

/// A day of a seconds pendulum whose rate follows the temperature, and what became of it.
class WeatheredLog {
public:
  WeatheredLog(const Thermometer& thermometer, std::uint64_t seed)
      : thermometer_(thermometer), seed_(seed), jitter_(seed, StreamPurpose::jitter),
        drive_(seed, StreamPurpose::fast_drive), air_(seed, StreamPurpose::temperature_noise) {
    coefficient_ = -6e-6 * std::exp2(air_.normal());
    const double jitter_s = 1e-4 * std::exp2(1.5 * jitter_.normal());
    const double white = 3e-6 * std::exp2(1.5 * drive_.normal());
    log_.source = "clock";
    log_.nominal_period_s = period_s;
    double late = 0.0, wander = 0.0;
    const double phase = air_.normal();
    for (int i = 0; i < beats; ++i) {
      const double t = period_s * i;
      const double warm =
          20.0 + wander + 1.5 * std::sin(2.0 * std::numbers::pi * (t / 86400.0) + phase);
      temperature_.push_back(warm);
      log_.events.push_back(event_at(Instant::from_seconds(t + late + jitter_s * jitter_.normal()),
                                     Edge::up, static_cast<std::uint32_t>(i + 1)));
      late -= period_s * (coefficient_ * (warm - 20.0) + white * drive_.normal());
      wander += thermometer.wander_k * std::sqrt(period_s / 600.0) * air_.normal();
    }
  }

  /// Writes the readings and gives back the effect that is found with them.
  CovariateEffect found(const std::string& path) {
    std::ofstream(path) << readings();
    LoadRequest request;
    request.weather.files = {path};
    const auto effects = covariate_effects(fit_data(load_events(log_, request)));
    return effects.at(0);
  }
  /// With a temperature at each beat.
  CovariateEffect found_with_own() {
    ClockLog log = log_;
    log.columns.temperature_c = temperature_;
    return covariate_effects(fit_data(load_events(std::move(log), {}))).at(0);
  }
  [[nodiscard]] double coefficient() const { return coefficient_; }

private:
  static constexpr int beats = 43200;
  static constexpr double period_s = 2.0;

  std::string readings() {
    RandomStream noise(seed_, StreamPurpose::amplitude_noise);
    std::string text = "time_s,temperature_c\n";
    for (double t = 0.0; t <= 86400.0; t += thermometer_.step_s) {
      const auto beat = static_cast<std::size_t>(std::min(t / period_s, beats - 1.0));
      const double value = temperature_[beat] + thermometer_.reading_sigma_k * noise.normal();
      const double of_hole = std::fmod(t + 3600.0, 6.0 * 3600.0);
      if (thermometer_.has_holes && of_hole < 7200.0) continue;
      text += fmt::format("{:.1f},{:.5f}\n", t, value);
    }
    return text;
  }

  const Thermometer& thermometer_;
  std::uint64_t seed_;
  RandomStream jitter_, drive_, air_;
  double coefficient_ = 0.0;
  ClockLog log_;
  std::vector<double> temperature_;
};

/// How the intervals of the coefficient fare.
struct WeatherScore {
  int logs = 0, within68 = 0, within95 = 0;
  double z2 = 0.0, worst_shift = 0.0, shift2 = 0.0; ///< shift: from the coefficient with all temperatures, in sigma

  void add(WeatheredLog& log, const std::string& path) {
    const CovariateEffect own = log.found_with_own(), found = log.found(path);
    const double z = (found.coefficient - log.coefficient()) / found.sigma;
    const double shift = (found.coefficient - own.coefficient) / found.sigma;
    ++logs;
    within68 += std::abs(z) < 0.994458 ? 1 : 0; // quantiles of the normal law
    within95 += std::abs(z) < 1.959964 ? 1 : 0;
    z2 += z * z;
    shift2 += shift * shift;
    worst_shift = std::max(worst_shift, std::abs(shift));
  }
};

} // namespace goingrate::test

// What surrounds a clock, as `spectrum` and `report` tell it: the share of the tide in phases of
// two years, a rod whose compensation lags, the barometer's two ways, and a clock fitted beside a
// thermometer that errs. How often the 68 % and 95 % intervals hold.
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/analysis/fit_request.hpp"
#include "goingrate/dynamics/stationary.hpp"
#include "goingrate/log/tides.hpp"

#include "support/simulated.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <numbers>
#include <random>
#include <string>
#include <vector>

using namespace goingrate;

namespace {

constexpr double day_s = 86400.0, per_day = 86400.0;

class Score {
public:
  void add(double value, double sigma, double truth) {
    const double z = (value - truth) / sigma;
    ++logs_;
    held68_ += std::abs(z) <= 1.0 ? 1 : 0;
    held95_ += std::abs(z) <= 1.96 ? 1 : 0;
    z_ += z;
    z2_ += z * z;
    sigma_ += sigma;
  }
  void print(const char* what, double unit, const char* unit_name) const {
    const double n = std::max(1, logs_), mean = z_ / n;
    std::printf(
        "  %-34s %3d told, 68 %% holds %.2f, 95 %% %.2f, pull %+.2f sd %.2f, sigma %.2g %s\n", what,
        logs_, held68_ / n, held95_ / n, mean, std::sqrt(std::max(0.0, z2_ / n - mean * mean)),
        unit * sigma_ / n, unit_name);
  }

private:
  int logs_ = 0, held68_ = 0, held95_ = 0;
  double z_ = 0.0, z2_ = 0.0, sigma_ = 0.0;
};

/// The seed of one log; no two scenes share one.
std::uint64_t seed_of(std::uint64_t first, int scene, int log) {
  constexpr std::uint64_t most_logs = 1000; // of a scene
  return first + most_logs * static_cast<std::uint64_t>(scene) + static_cast<std::uint64_t>(log);
}

class Noise {
public:
  explicit Noise(std::uint64_t seed) : random_(seed) {}
  double normal() { return normal_(random_); }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

/// A smooth course: sines of 0.8 to 5 days of random phases.
class Course {
public:
  Course(double rms, Noise& noise) {
    for (const double days : {5.1, 3.3, 2.1, 1.4, 0.8})
      waves_.push_back({rms * noise.between(0.5, 1.0), days * day_s * noise.between(0.9, 1.1),
                        noise.between(0.0, 2.0 * std::numbers::pi)});
  }
  double at(double t) const {
    double sum = 0.0;
    for (const auto& [size, period, phase] : waves_)
      sum += size * std::sin(2.0 * std::numbers::pi * t / period + phase);
    return sum;
  }

private:
  struct Wave {
    double size, period, phase;
  };
  std::vector<Wave> waves_;
};

std::vector<CovariateEffect> effects_of(const NumberedLog& loaded) {
  return covariate_effects(fit_data(loaded));
}

const CovariateEffect* effect_named(const std::vector<CovariateEffect>& effects,
                                    std::string_view name) {
  for (const CovariateEffect& effect : effects)
    if (effect.name == name) return &effect;
  return nullptr;
}

enum class Kind { white, flicker, walk };

// Clock errors every half hour for `days`, dated, with the tides of Greenwich.
std::string dated_phases(double days, Kind kind, double daily, double share, std::uint64_t seed) {
  constexpr double step_s = 1800.0;
  const Site site{51.4779, -0.0015};
  Noise noise(seed);
  const Instant begin{static_cast<std::int64_t>(1'700'000'000 + seed % 1000 * 86'400), 0.0};
  const auto count = static_cast<std::size_t>(days * day_s / step_s) + 1;
  std::vector<double> elapsed(count);
  for (std::size_t i = 0; i < count; ++i)
    elapsed[i] = step_s * static_cast<double>(i);
  const auto tide = tidal_advance(elapsed, begin, site);
  const double steps = day_s / step_s;
  std::string text = "# latitude_deg: 51.4779\n# longitude_deg: -0.0015\n";
  double phase = 0.0, walk = 0.0;
  std::vector<double> slow(12, 0.0); // Ornstein-Uhlenbeck, an octave and a half apart: flicker
  for (std::size_t i = 0; i < count; ++i) {
    const double mjd = 40587.0 + (static_cast<double>(begin.seconds) + elapsed[i]) / day_s;
    text += fmt::format("{:.6f} {:.15e}\n", mjd, phase + share * tide[i]);
    double rate = 0.0;
    if (kind == Kind::white) rate = daily * std::sqrt(steps) * noise.normal();
    if (kind == Kind::walk) rate = walk += daily * std::sqrt(3.0 / steps) * noise.normal();
    if (kind == Kind::flicker)
      for (std::size_t k = 0; k < slow.size(); ++k) {
        const double keep = std::exp(-1.0 / std::pow(2.8, static_cast<double>(k)));
        slow[k] = keep * slow[k] + 0.85 * daily * std::sqrt(1.0 - keep * keep) * noise.normal();
        rate += slow[k];
      }
    phase += step_s * rate;
  }
  return text;
}

// "60000.020833 -1.2e-7": MJD and the clock's error.
LoadRequest dated() {
  LoadRequest request;
  request.path = "phases";
  request.reading.columns = {"time=1:mjd", "phase=2"};
  return request;
}

void tides(std::uint64_t seed, int logs) {
  std::printf("tide in half-hourly phases of two years, sigma_y(1 day) 1e-9\n");
  for (const auto& [kind, name] : {std::pair{Kind::white, "white noise of the rate"},
                                   std::pair{Kind::flicker, "flicker of the rate"},
                                   std::pair{Kind::walk, "random walk of the rate"}}) {
    Score score;
    for (int i = 0; i < logs; ++i) {
      const LoadRequest request = dated();
      const auto own = seed_of(seed, static_cast<int>(kind), i);
      const auto effects =
          effects_of(load_text(dated_phases(730.0, kind, 1e-9, 1.0, own), request));
      if (const CovariateEffect* effect = effect_named(effects, "tide"))
        score.add(effect->coefficient, effect->sigma, 1.0);
    }
    score.print(name, 1.0, "of theory");
  }
  Score ordinary;
  int claimed = 0;
  for (int i = 0; i < logs; ++i) {
    const LoadRequest request = dated();
    const auto own = seed_of(seed, 3, i);
    const auto effects =
        effects_of(load_text(dated_phases(60.0, Kind::walk, 1e-6, 1.0, own), request));
    const CovariateEffect* effect = effect_named(effects, "tide");
    if (effect == nullptr) continue;
    ordinary.add(effect->coefficient, effect->sigma, 1.0);
    claimed += effect->significant() ? 1 : 0;
  }
  ordinary.print("longcase, 1e-6 a day, 60 days", 1.0, "of theory");
  std::printf("  of these said to stand out of the noise: %d\n", claimed);
}

void rods(std::uint64_t seed, int logs) {
  std::printf("a rod of 12e-6/K whose compensation lags, 9 days, drive 0.1 fast and 0.01 slow, "
              "jitter 0.1 ms\n");
  int scene = 10;
  struct Rod {
    double compensation, lag_h;
    bool in_weather; ///< or in a temperature that varies by the day alone
  };
  for (const auto& [compensation, lag_h, in_weather] :
       {Rod{0.0, 0.0, true}, Rod{11.4e-6, 2.0, true}, Rod{12e-6, 4.0, true}, Rod{11e-6, 8.0, true},
        Rod{0.0, 0.0, false}, Rod{11.4e-6, 2.0, false}, Rod{12e-6, 4.0, false}}) {
    ++scene;
    Score whole, rod;
    int twice = 0;
    double lag = 0.0;
    for (int i = 0; i < logs; ++i) {
      const auto own = seed_of(seed, scene, i);
      Noise noise(own);
      Scenario scenario;
      scenario.clock = {2.0, 1.2e-4, 1.5e-5, 0.03};
      scenario.duration_s = 9.0 * day_s;
      scenario.method.method = Method::averaged2;
      scenario.length.temperature_coefficient = 12e-6;
      scenario.length.compensation = compensation;
      scenario.length.compensation_lag_s = lag_h * 3600.0;
      scenario.temperature.sines = {{1.5 * noise.between(0.5, 1.0), day_s}};
      if (in_weather) {
        scenario.temperature.sines.push_back({2.0 * noise.between(0.5, 1.0), 2.3 * day_s});
        scenario.temperature.sines.push_back({3.0 * noise.between(0.5, 1.0), 5.1 * day_s});
      }
      scenario.drive.fast_rms = 0.1;
      scenario.drive.slow_rms = 0.01;
      scenario.drive.slow_time_s = 20'000.0;
      scenario.sensor.jitter_rms_s = 1e-4;
      scenario.sensor.temperature_rms = 0.02;
      LoadRequest request;
      const auto effects = effects_of(load_events(test::simulated_log(scenario, own), request));
      const CovariateEffect* effect = effect_named(effects, "temperature");
      if (effect == nullptr) continue;
      whole.add(effect->coefficient, effect->sigma, -0.5 * (12e-6 - compensation));
      const EffectPart* at_once = effect->part(EffectWay::at_once);
      if (at_once == nullptr) continue;
      ++twice;
      lag += effect->lag_s / 3600.0;
      rod.add(at_once->coefficient, at_once->sigma, -6e-6);
    }
    std::printf(" compensation %.3g/K, lag %.3g h, %s: two ways told in %d of %d, lag %.2f h\n",
                compensation, lag_h, in_weather ? "weather" : "a daily wave alone", twice, logs,
                lag / std::max(1, twice));
    whole.print("the whole", per_day, "s/day/K");
    rod.print("the rod at once", per_day, "s/day/K");
  }
}

// The barometer: friction follows the pressure by changes of epsilon every ten minutes, buoyancy by
// a stretch of the times.
void barometers(std::uint64_t seed, int logs) {
  std::printf("the barometer's two ways, 6 days, amplitudes logged to 0.1 mrad\n");
  constexpr double buoyancy = -1.5e-7, friction = 8e-4; // per mbar, of the rate and of epsilon
  for (const bool knows_clock : {true, false}) {
    Score direct, through, whole;
    for (int i = 0; i < logs; ++i) {
      const auto own = seed_of(seed, knows_clock ? 20 : 21, i);
      Noise noise(own);
      const Course pressure(6.0, noise);
      Scenario scenario;
      scenario.clock = {2.0, 1.2e-4, 1.5e-5, 0.03};
      scenario.duration_s = 6.0 * day_s;
      scenario.method.method = Method::averaged2;
      scenario.drive.fast_rms = 0.02;
      scenario.sensor.jitter_rms_s = 1e-4;
      scenario.sensor.amplitude_rms = 1e-4;
      for (double t = 0.0; t < *scenario.duration_s; t += 600.0) {
        ClockEvent event;
        event.at_period = static_cast<std::int64_t>(t / 2.0) + 1;
        event.epsilon = scenario.clock.epsilon * (1.0 + friction * pressure.at(t + 300.0));
        scenario.events.push_back(event);
      }
      ClockLog log = test::simulated_log(scenario, own);
      double ahead = 0.0, before = 0.0;
      for (Beat& beat : log.events) {
        const double t = beat.time.to_double();
        ahead += buoyancy * pressure.at(0.5 * (t + before)) * (t - before);
        before = t;
        beat.time = beat.time + (-ahead);
        log.columns.pressure_mbar.push_back(1013.0 + pressure.at(t) + 0.1 * noise.normal());
      }
      LoadRequest request;
      const NumberedLog loaded = load_events(std::move(log), request);
      FitRequest fit;
      if (knows_clock) fit.fixed = {{"phi0", 0.03}, {"epsilon", scenario.clock.epsilon}};
      fit.events = {"none"};
      const TimingData times = fit_data(loaded);
      const FitSummary summary =
          fit_clock(times, loaded.nominal_period_s, fit_options(fit, loaded));
      auto effects = covariate_effects(times);
      tell_ways(times, summary, effects);
      const CovariateEffect* effect = effect_named(effects, "pressure");
      if (effect == nullptr) continue;
      const ClockParameters& clock = scenario.clock;
      ClockParameters denser = clock;
      denser.epsilon *= 1.0 + friction;
      const double by_friction =
          *stationary_rate_first_order(denser) - *stationary_rate_first_order(clock);
      const double wide = *stationary_amplitude(clock), narrow = *stationary_amplitude(denser);
      const double by_circle = (wide * wide - narrow * narrow) / 16.0;
      whole.add(effect->coefficient, effect->sigma, buoyancy + by_friction);
      const EffectPart* way = effect->part(EffectWay::through_amplitude);
      if (way == nullptr) way = effect->part(EffectWay::circular_error);
      const EffectPart* rest = effect->part(EffectWay::direct);
      const bool is_known = rest != nullptr;
      if (!is_known) rest = effect->part(EffectWay::other);
      if (way == nullptr || rest == nullptr) continue;
      const double truth = is_known ? by_friction : by_circle;
      through.add(way->coefficient, way->sigma, truth);
      direct.add(rest->coefficient, rest->sigma, buoyancy + by_friction - truth);
    }
    std::printf(knows_clock ? " friction and phi0 told\n" : " nothing told\n");
    whole.print("the whole", per_day * 1e3, "ms/day/mbar");
    through.print(knows_clock ? "through the amplitude" : "by the circular error", per_day * 1e3,
                  "ms/day/mbar");
    direct.print(knows_clock ? "directly" : "otherwise", per_day * 1e3, "ms/day/mbar");
  }
}

// The thermometer beside the clock errs in each reading: what is fitted beside its coefficient, and
// that itself. The longcase clock of the example, 20,000 s, its drive from swing to swing alone or
// wandering too, and other readings.
void thermometers(std::uint64_t seed, int logs) {
  std::printf("a longcase clock beside a thermometer, 20,000 s, amplitudes to 0.02 mrad\n");
  struct Scene {
    const char* what;
    double error_k, slow_rms;
  };
  int scene_number = 30;
  for (const Scene& scene :
       {Scene{"errors of 0.1 K, drive wanders", 0.1, 0.01}, Scene{"errors of 0.1 K", 0.1, 0.0},
        Scene{"errors of 0.02 K", 0.02, 0.0}}) {
    Score warmth, epsilon, mu, phi0;
    for (int i = 0; i < logs; ++i) {
      const auto own = seed_of(seed, scene_number, i);
      Scenario scenario;
      scenario.clock = {2.0, 2.5e-4, 3.7e-5, 0.03};
      scenario.duration_s = 20'000.0;
      scenario.drive.fast_rms = 0.02;
      scenario.drive.slow_rms = scene.slow_rms;
      scenario.drive.slow_time_s = 7200.0;
      scenario.length.temperature_coefficient = 1.15e-5;
      scenario.temperature.sines = {{1.5, day_s}};
      scenario.sensor.edges = SensorEdges::both;
      scenario.sensor.jitter_rms_s = 2e-5;
      scenario.sensor.amplitude_rms = 2e-5;
      scenario.sensor.temperature_rms = scene.error_k;
      LoadRequest request;
      const NumberedLog loaded = load_events(test::simulated_log(scenario, own), request);
      FitRequest fit;
      fit.events = {"none"};
      const FitSummary found =
          fit_clock(fit_data(loaded), loaded.nominal_period_s, fit_options(fit, loaded));
      const auto add = [&](const char* name, double truth, Score& score) {
        const FittedParameter* one = found.find(name);
        if (one != nullptr && std::isfinite(one->sigma)) score.add(one->value, one->sigma, truth);
      };
      add("temperature", -0.5 * 1.15e-5, warmth);
      add("epsilon", scenario.clock.epsilon, epsilon);
      add("mu", scenario.clock.mu, mu);
      add("phi0", scenario.clock.phi0, phi0);
    }
    ++scene_number;
    std::printf(" %s\n", scene.what);
    warmth.print("the temperature", per_day, "s/day/K");
    epsilon.print("the friction", 1e6, "1e-6");
    mu.print("the torque", 1e6, "1e-6");
    phi0.print("the angle of the escapement", 1e3, "mrad");
  }
}

} // namespace

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const std::uint64_t seed = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1;
  const int logs = argc > 2 ? std::atoi(argv[2]) : 20;
  const std::string_view part = argc > 3 ? argv[3] : "all";
  if (part == "all" || part == "tides") tides(seed, logs);
  if (part == "all" || part == "rods") rods(seed, logs);
  if (part == "all" || part == "barometers") barometers(seed, logs);
  if (part == "all" || part == "thermometers") thermometers(seed, logs);
}

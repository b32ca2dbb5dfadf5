// Ring-downs whose friction is known, as the logs that students bring: samples of an angle,
// crossings alone, or a photogate with the flag's dark time.
#pragma once

#include "goingrate/analysis/load.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/dynamics/swing_loss.hpp"
#include "support/simulated.hpp"
#include "support/swinging.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <string>

namespace goingrate::test {

enum class WatchedBy { samples, crossings, photogate };

struct RingDown {
  std::string law; // as the fit names it
  WatchedBy watched_by = WatchedBy::samples;
  Friction friction;
  double T0 = 1.0, first_rad = 0.1, last_rad = 0.05;
  double swings = 100.0;
  double noise = 0.0; // rad of a sample, or s of an edge
  std::string text;   // of the log
  LoadRequest request;
};

/// Draws a ring-down: T0 0.7 to 3 s, first amplitude 0.02 to 1 rad, 30 to 3000 swings in which the
/// amplitude falls by a factor of 1.3 to 8, the laws with two or three terms each with a share of
/// 0.15 or more of the loss halfway.
class RingDownPrior {
public:
  explicit RingDownPrior(std::uint64_t seed)
      : seed_(seed), chance_(seed, StreamPurpose::amplitude_noise) {}

  RingDown draw(const std::string& law, WatchedBy watched_by) {
    RingDown drawn;
    drawn.law = law;
    drawn.watched_by = watched_by;
    drawn.T0 = between(0.7, 3.0);
    drawn.first_rad = geometric(0.02, 1.0);
    drawn.swings = geometric(30.0, 3000.0);
    const double falls = geometric(1.3, 8.0);
    drawn.last_rad = drawn.first_rad / falls;
    draw_friction(drawn);
    if (watched_by == WatchedBy::samples)
      sample(drawn);
    else
      time_crossings(drawn);
    return drawn;
  }

private:
  double between(double low, double high) { return low + (high - low) * chance_.uniform(); }
  double geometric(double low, double high) {
    return low * std::exp(std::log(high / low) * chance_.uniform());
  }

  // How long it takes to fall from the first to the last amplitude, in periods of small swings.
  static double periods_to_fall(const Friction& friction, double first, double last) {
    constexpr int steps = 400;
    double periods = 0.0;
    for (int k = 0; k < steps; ++k) {
      const double at = first * std::pow(last / first, (k + 0.5) / steps);
      periods +=
          std::log(first / last) / steps * quality_factor(friction, at) * decay_periods_per_q(at);
    }
    return periods;
  }

  void draw_friction(RingDown& drawn) {
    const double halfway = std::sqrt(drawn.first_rad * drawn.last_rad);
    const auto per_term = inverse_q_per_friction(halfway);
    std::array<double, 3> share{};
    const auto has = [&](const char* word) { return drawn.law.find(word) != std::string::npos; };
    if (has("linear")) share[0] = between(0.15, 0.7);
    if (has("quadratic")) share[1] = between(0.15, 0.7);
    if (has("dry")) share[2] = between(0.15, 0.7);
    const double sum = share[0] + share[1] + share[2];
    Friction& f = drawn.friction;
    f = {share[0] / sum / per_term[0], share[1] / sum / per_term[1], share[2] / sum / per_term[2]};
    const double too_long = periods_to_fall(f, drawn.first_rad, drawn.last_rad) / drawn.swings;
    f = {f.epsilon * too_long, f.quadratic * too_long, f.dry * too_long};
  }

  // A phone or a video: 20 to 60 samples per second, noise of 0.3 to 3 % of the last amplitude.
  void sample(RingDown& drawn) {
    const double rate_hz = between(20.0, 60.0), rest = between(-0.02, 0.02);
    drawn.noise = drawn.last_rad * geometric(0.003, 0.03);
    const double length_s = drawn.swings * drawn.T0 * circular_period_ratio(drawn.first_rad * 0.7);
    RandomStream noise(seed_, StreamPurpose::jitter);
    const double dt = 2.0 * std::numbers::pi / (drawn.T0 * rate_hz);
    Swinging motion{drawn.first_rad, 0.0};
    drawn.text = "time_s,angle_rad\n";
    for (int i = 0; i / rate_hz < length_s; ++i) {
      drawn.text += fmt::format("{:.6f},{:.7f}\n", i / rate_hz,
                                motion.angle + rest + drawn.noise * noise.normal());
      motion.go_on(drawn.friction, dt);
    }
  }

  // Jitter of 1e-5 to 1e-3 s of the crossings, of 1e-5 to 2e-4 s of a photogate's edges.
  void time_crossings(RingDown& drawn) {
    const bool gate = drawn.watched_by == WatchedBy::photogate;
    Scenario scenario;
    scenario.clock = {drawn.T0, drawn.friction.epsilon, 0.0, 0.0, Escapement::none};
    scenario.clock.quadratic_drag = drawn.friction.quadratic;
    scenario.clock.dry_friction = drawn.friction.dry;
    scenario.start_amplitude = 2.0 * std::sin(0.5 * drawn.first_rad);
    scenario.periods = static_cast<std::int64_t>(drawn.swings);
    scenario.method.method = Method::direct;
    drawn.noise = gate ? geometric(1e-5, 2e-4) : geometric(1e-5, 1e-3);
    scenario.sensor.jitter_rms_s = drawn.noise;
    scenario.sensor.edges = gate ? SensorEdges::gate : SensorEdges::up;
    if (gate) scenario.sensor.flag_width_rad = drawn.last_rad * between(0.1, 0.5);
    const ClockLog log = simulated_log(scenario, seed_);
    drawn.text = gate ? "time_s,edge,width_s\n" : "time_s\n";
    for (std::size_t i = 0; i < log.events.size(); ++i) {
      const double width = gate ? log.columns.width_s[i] : 0.0;
      const double leading = log.events[i].time - Instant{} - 0.5 * width;
      drawn.text += gate ? fmt::format("{:.9f},{},{:.9f}\n", leading,
                                       log.events[i].edge == Edge::up ? "up" : "down", width)
                         : fmt::format("{:.9f}\n", leading);
    }
    if (gate) drawn.request.flag_width_rad = scenario.sensor.flag_width_rad;
  }

  std::uint64_t seed_;
  RandomStream chance_;
};

} // namespace goingrate::test

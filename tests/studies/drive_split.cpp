// Coverage and bias of the fast and slow rms of the drive. First with the clock known: logs of
// point B with fast drive of 30 %. Then as users have it: several clocks, each fitted by analyse()
// from a log with amplitudes in which the drive changes by half, T0 being known. Arguments: logs
// in all of the first kind (200), of the second (40), first seed (1).
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/log/rates.hpp"
#include "support/simulated.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <numbers>
#include <optional>
#include <string>
#include <thread>

namespace {

using namespace goingrate;

constexpr double relaxation_s = 637.0; // T0/(4 pi epsilon)

struct Scene {
  double slow_rms, slow_time_s;
};

struct Score {
  int logs = 0, inside = 0, limits = 0;
  double sum = 0.0, sum2 = 0.0;                 // of (value - truth)/(half the interval)
  double error = 0.0, error2 = 0.0, half = 0.0; // of value/truth - 1, and of half the interval so

  void add(const RmsEstimate& estimate, double truth) {
    ++logs;
    inside += estimate.low68 <= truth && truth <= estimate.high68 ? 1 : 0;
    limits += estimate.low68 == 0.0 ? 1 : 0;
    const double sigma = 0.5 * (estimate.high68 - estimate.low68);
    const double z = std::isfinite(sigma) ? (estimate.rms - truth) / sigma : 0.0;
    error += estimate.rms / truth - 1.0;
    error2 += std::pow(estimate.rms / truth - 1.0, 2);
    half += sigma / truth;
    sum += z;
    sum2 += z * z;
  }
  void add(const Score& other) {
    logs += other.logs;
    inside += other.inside;
    limits += other.limits;
    sum += other.sum;
    sum2 += other.sum2;
    error += other.error;
    error2 += other.error2;
    half += other.half;
  }
  void print(const char* name) const {
    const double n = logs, mean = sum / n;
    std::printf("  %-5s in 68 %% %.3f, bias %+.3f +- %.3f sigma, upper limits %d", name, inside / n,
                mean, std::sqrt((sum2 / n - mean * mean) / n), limits);
    std::printf(", error %+.4f, scatter %.4f, half interval %.4f", error / n,
                std::sqrt(error2 / n - std::pow(error / n, 2)), half / n);
  }
};

// A clock of T0 (s), Q, amplitude of rest (rad) and lambda/phi0.
struct Clock {
  double period_s, quality, amplitude, ratio;
};

Scenario scene_with(const Clock& own) {
  const double epsilon = 0.5 / own.quality, phi0 = own.amplitude / own.ratio;
  Scenario scenario;
  scenario.clock = {own.period_s, epsilon,
                    0.5 * std::numbers::pi * epsilon * own.amplitude * own.amplitude / phi0, phi0};
  scenario.periods = 20000;
  ClockEvent event;
  event.at_period = 3000;
  event.mu = 1.5 * scenario.clock.mu;
  scenario.events = {event};
  scenario.drive = {0.03, 0.02, 4.0 * own.period_s * own.quality / (2.0 * std::numbers::pi)};
  scenario.sensor.jitter_rms_s = 1e-6;
  scenario.sensor.amplitude_rms = 1e-3 * own.amplitude;
  return scenario;
}

// Nothing where the fit does not determine the gains.
std::optional<DriveSplit> split_as_users_get_it(const Scenario& scenario, std::uint64_t seed) {
  std::string text = "time (s),amplitude (rad)\n";
  for (const Beat& beat : test::simulated_log(scenario, seed).events)
    text += fmt::format("{:.10f},{:.8f}\n", beat.time.to_double(), beat.amplitude_rad);
  LoadRequest request;
  request.path = "split.csv";
  request.reading.nominal_period_s = scenario.clock.nominal_period_s;
  AnalysisRequest asked;
  asked.traces_profiles = false;
  asked.fit.fixed["T0"] = scenario.clock.nominal_period_s;
  return analyse(load_text(text, request), asked).drive.split;
}

DriveSplit split_of(const Scene& scene, std::uint64_t seed) {
  const double turns = 30.0; // memories in a log
  const auto periods = static_cast<std::int64_t>(std::max(1e5, turns * scene.slow_time_s / 2.0));
  Scenario scenario = test::at_point_b(periods);
  scenario.drive = {0.3, scene.slow_rms, scene.slow_time_s};
  scenario.sensor.jitter_rms_s = 1e-6;
  const auto rates = rate_on_every_cycle(test::simulated_beats(scenario, seed), 2.0);
  return split_drive(rates, 2.0, *drive_response(scenario.clock));
}

// f(i) for i from 0 to n - 1, on two threads.
template <class Result, class F> std::vector<Result> in_two_halves(std::size_t n, const F& f) {
  std::vector<Result> results(n);
  const auto half = [&](std::size_t first) {
    for (std::size_t i = first; i < n; i += 2)
      results[i] = f(i);
  };
  std::thread other(half, 1);
  half(0);
  other.join();
  return results;
}

void print_all(int logs, const char* of, const Score& fast, const Score& slow) {
  std::printf("all %d logs%s:\n", logs, of);
  fast.print("fast");
  std::printf("\n");
  slow.print("slow");
  std::printf("\n");
}

} // namespace

int main(int count, char** words) {
  const int logs = count > 1 ? std::atoi(words[1]) : 200;
  const auto seed = static_cast<std::uint64_t>(count > 3 ? std::atoll(words[3]) : 1);
  std::vector<Scene> scenes;
  for (const double rms : {0.01, 0.03, 0.1, 0.3})
    for (const double relaxations : {0.1, 1.0, 10.0, 100.0})
      scenes.push_back({rms, relaxations * relaxation_s});
  const auto each = static_cast<std::size_t>(
      std::max(1, (logs + static_cast<int>(scenes.size()) - 1) / static_cast<int>(scenes.size())));
  Score all_fast, all_slow;
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    const auto splits = in_two_halves<DriveSplit>(
        each, [&](std::size_t i) { return split_of(scenes[k], seed + 1000 * k + i); });
    Score fast, slow;
    for (const DriveSplit& split : splits) {
      fast.add(split.fast, 0.3);
      slow.add(split.slow, scenes[k].slow_rms);
    }
    std::printf("slow rms %.2f, memory %6.0f s:", scenes[k].slow_rms, scenes[k].slow_time_s);
    fast.print("fast");
    slow.print("slow");
    std::printf("\n");
    std::fflush(stdout);
    all_fast.add(fast);
    all_slow.add(slow);
  }
  print_all(all_fast.logs, "", all_fast, all_slow);

  std::printf("\nfitted clocks:\n");
  const int fitted = count > 2 ? std::atoi(words[2]) : 40;
  const std::vector<Clock> clocks{{2.0, 2000.0, 0.055, 1.84},
                                  {0.8, 300.0, 0.08, 1.5},
                                  {1.0, 1000.0, 0.04, 3.0},
                                  {3.0, 6000.0, 0.046, 2.0}};
  Score fitted_fast, fitted_slow;
  for (std::size_t k = 0; k < clocks.size(); ++k) {
    const Scenario scenario = scene_with(clocks[k]);
    const auto splits = in_two_halves<std::optional<DriveSplit>>(
        static_cast<std::size_t>(fitted) / clocks.size(),
        [&](std::size_t i) { return split_as_users_get_it(scenario, seed + 1000 * k + i); });
    Score fast, slow;
    for (const auto& split : splits) {
      if (!split) continue;
      fast.add(split->fast, scenario.drive.fast_rms);
      slow.add(split->slow, scenario.drive.slow_rms);
    }
    std::printf("T0 %.1f s, Q %.0f, lambda/phi0 %.2f: %d of %zu split", clocks[k].period_s,
                clocks[k].quality, clocks[k].ratio, fast.logs, splits.size());
    if (fast.logs > 0) {
      fast.print("fast");
      slow.print("slow");
    }
    std::printf("\n");
    std::fflush(stdout);
    fitted_fast.add(fast);
    fitted_slow.add(slow);
  }
  print_all(fitted_fast.logs, " with fitted clocks", fitted_fast, fitted_slow);
}

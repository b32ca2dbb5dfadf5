// Coverage and bias of the fast and slow rms of the drive, on simulated logs of point B with fast
// drive of 30 %. Argument: logs in all (200).
#include "goingrate/fit/drive_split.hpp"
#include "goingrate/log/rates.hpp"
#include "support/simulated.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
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

DriveSplit split_of(const Scene& scene, std::uint64_t seed) {
  const double turns = 30.0; // memories in a log
  const auto periods = static_cast<std::int64_t>(std::max(1e5, turns * scene.slow_time_s / 2.0));
  Scenario scenario = test::at_point_b(periods);
  scenario.drive = {0.3, scene.slow_rms, scene.slow_time_s};
  scenario.sensor.jitter_rms_s = 1e-6;
  const auto rates = rate_on_every_cycle(test::simulated_beats(scenario, seed), 2.0);
  return split_drive(rates, 2.0, *drive_response(scenario.clock));
}

} // namespace

int main(int count, char** words) {
  const int logs = count > 1 ? std::atoi(words[1]) : 200;
  std::vector<Scene> scenes;
  for (const double rms : {0.01, 0.03, 0.1, 0.3})
    for (const double relaxations : {0.1, 1.0, 10.0, 100.0})
      scenes.push_back({rms, relaxations * relaxation_s});
  const auto each = static_cast<std::size_t>(
      std::max(1, (logs + static_cast<int>(scenes.size()) - 1) / static_cast<int>(scenes.size())));
  Score all_fast, all_slow;
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    std::vector<DriveSplit> splits(each);
    const auto half = [&](std::size_t first) {
      for (std::size_t i = first; i < each; i += 2)
        splits[i] = split_of(scenes[k], 1000 * (k + 1) + i);
    };
    std::thread other(half, 1);
    half(0);
    other.join();
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
  std::printf("all %d logs:\n", all_fast.logs);
  all_fast.print("fast");
  std::printf("\n");
  all_slow.print("slow");
  std::printf("\n");
}

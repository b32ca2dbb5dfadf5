// Pushes of escapements that rest, as analyse() sees them: how often N is found and right, and how
// often the intervals of the push and of the friction hold. Clocks are drawn with a seed: T0 0.8 to
// 3 s, Q 2000 to 50,000, amplitude 0.015 to 0.05 rad, N 2 to 60 or a Hipp, 1500 to 20,000 periods,
// jitter 0.3 to 30 us; healthy ones with noise of the drive, and with wheels that are not round.
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/analysis/simulated_logs.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>

using namespace goingrate;

namespace {

class Draw {
public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double log_between(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  }
  bool one_in(int n) { return std::uniform_int_distribution<int>(1, n)(random_) == 1; }

private:
  std::mt19937_64 random_;
};

enum class Kind { once_in_n, hipp, healthy, wheel };

Scenario drawn(Kind kind, Draw& draw, bool amplitudes) {
  Scenario scenario;
  ClockParameters& clock = scenario.clock;
  clock.nominal_period_s = draw.between(0.8, 3.0);
  clock.epsilon = 0.5 / draw.log_between(2000.0, 50'000.0);
  const double lambda = draw.between(0.015, 0.05);
  const double power = 2.0 * std::numbers::pi * clock.epsilon * lambda * lambda;
  scenario.periods = static_cast<std::int64_t>(draw.log_between(1500.0, 20'000.0));
  scenario.sensor.jitter_rms_s = draw.log_between(3e-7, 3e-5);
  if (amplitudes) scenario.sensor.amplitude_rms = draw.log_between(1e-6, 1e-4);
  scenario.drive.fast_rms = draw.log_between(1e-3, 0.1);
  if (kind == Kind::once_in_n || kind == Kind::hipp) {
    clock.escapement = Escapement::single_impulse;
    clock.impulse_angle = draw.between(-0.3, 0.3) * lambda;
    clock.every = static_cast<std::int64_t>(draw.between(2.0, 61.0));
    clock.impulse = power * static_cast<double>(clock.every);
    if (kind == Kind::hipp) {
      clock.below = std::sqrt(lambda * lambda - clock.impulse);
      clock.every = 1;
    }
    return scenario;
  }
  clock.phi0 = lambda / draw.between(1.3, 3.0);
  clock.mu = power / (4.0 * clock.phi0);
  if (kind == Kind::wheel)
    scenario.drive.sines = {{draw.log_between(0.01, 0.3),
                             std::floor(draw.between(3.0, 61.0)) * clock.nominal_period_s}};
  return scenario;
}

struct Tally {
  int logs = 0, found = 0, right = 0, steps = 0, step68 = 0, friction68 = 0, over5 = 0;
  double z2 = 0.0;
};

// The step of the amplitude at a push, and N, of the clock as it is.
void judge(const Scenario& scenario, const ImpulseCycle& pushes, Tally& tally) {
  const ClockParameters& clock = scenario.clock;
  const bool hipp = clock.below > 0.0;
  const bool right =
      hipp ? !pushes.is_regular || std::abs(pushes.periods - std::round(pushes.periods)) < 0.02
           : pushes.periods == static_cast<double>(clock.every);
  tally.right += right ? 1 : 0;
  if (!right || !pushes.epsilon) return;
  ++tally.steps;
  const double z = (pushes.epsilon->value - clock.epsilon) / pushes.epsilon->sigma;
  tally.friction68 += std::abs(z) < 1.0 ? 1 : 0;
  tally.over5 += std::abs(z) > 5.0 ? 1 : 0;
  tally.z2 += z * z;
}

void row(const char* name, Kind kind, bool amplitudes, std::uint64_t seed, int logs) {
  Draw draw(seed);
  Tally tally;
  for (int k = 0; k < logs; ++k) {
    const Scenario scenario = drawn(kind, draw, amplitudes);
    SimulatedLogs simulated(scenario);
    const std::array<std::uint64_t, 1> one{seed * 1000 + static_cast<std::uint64_t>(k)};
    const TimingData data = fit_data(load_text(simulated.make(one).front().text, LoadRequest{}));
    ++tally.logs;
    if (!data.impulses) continue;
    ++tally.found;
    if (kind == Kind::once_in_n || kind == Kind::hipp) judge(scenario, *data.impulses, tally);
  }
  std::printf("%-34s %5d %6d %6d", name, tally.logs, tally.found, tally.right);
  if (tally.steps > 0)
    std::printf("  %5d  %.2f  %5.2f  %d", tally.steps,
                static_cast<double>(tally.friction68) / tally.steps,
                std::sqrt(tally.z2 / tally.steps), tally.over5);
  std::printf("\n");
}

} // namespace

int main(int argc, char** argv) {
  const auto seed = static_cast<std::uint64_t>(argc > 1 ? std::atoll(argv[1]) : 1);
  const int logs = argc > 2 ? std::atoi(argv[2]) : 100;
  std::printf("%-34s %5s %6s %6s  %5s  %s  %s  %s\n", "clock", "logs", "found", "right", "known",
              "68 %", "rms z", "over 5 sigma");
  for (const bool amplitudes : {true, false}) {
    const std::string with = amplitudes ? ", amplitudes" : ", times alone";
    row(("once in N" + with).c_str(), Kind::once_in_n, amplitudes, seed, logs);
    row(("a Hipp" + with).c_str(), Kind::hipp, amplitudes, seed + 1, logs);
    row(("every swing" + with).c_str(), Kind::healthy, amplitudes, seed + 2, logs);
    row(("a wheel not round" + with).c_str(), Kind::wheel, amplitudes, seed + 3, logs);
  }
}

// The long form of what the tests of the solvers show in short: figures over 1e5 and 1e8 periods,
// throughput, and the worst case of the automatic choice over a fine grid. Prints a table.
#include "base/scaled_time.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/base/thread_clock.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/ensemble.hpp"
#include "goingrate/dynamics/map.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

namespace {

using namespace goingrate;

const ClockParameters clock_c{two_pi, 1.167245e-4, 1.5e-5, 0.03};
const FactorRange noisy{1.0 - 7 * 0.3, 1.0 + 7 * 0.3};

double median_of_5(const auto& work) {
  std::array<double, 5> times;
  for (double& time : times)
    time = thread_seconds(work);
  std::nth_element(times.begin(), times.begin() + 2, times.end());
  return times[2];
}

// Direct integration and map against 64-bit integration, 1e5 noisy periods.
void noisy_crossings() {
  const double v = limit_cycle(clock_c)->velocity;
  DirectPendulum direct(clock_c, v);
  MapPendulum map(clock_c, v, noisy);
  RandomStream random(3, StreamPurpose::fast_drive);
  long double speed2 = static_cast<long double>(v) * v, exact = 0.0L;
  TwoPart<double> by_direct, by_map;
  double worst_direct = 0.0, worst_map = 0.0;
  const auto off = [&](const TwoPart<double>& time) {
    return static_cast<double>(std::abs((static_cast<long double>(time.hi) - exact) + time.lo));
  };
  for (int i = 0; i < 100000; ++i) {
    const double factor = 1.0 + 0.3 * random.normal();
    by_direct += direct.advance(factor).excess;
    by_map += map.advance(factor).excess;
    const auto period = regular_period<Wide>(clock_c, speed2, factor);
    speed2 += period.speed2_change;
    exact += period.excess;
    worst_direct = std::max(worst_direct, off(by_direct));
    worst_map = std::max(worst_map, off(by_map));
    if (i + 1 == 2000)
      std::printf("C, 30 %% noise, 2000 periods: direct off by %.1e, map by %.1e (scaled)\n",
                  worst_direct, worst_map);
  }
  std::printf("C, 30 %% noise, 1e5 periods:  direct off by %.1e, map by %.1e; %lld fallbacks\n",
              worst_direct, worst_map, static_cast<long long>(map.fallbacks()));
}

Scenario quasistat(std::int64_t periods) {
  Scenario scenario;
  scenario.clock = clock_c;
  scenario.clock.nominal_period_s = 2.0;
  scenario.periods = periods;
  scenario.drive.fast_rms = 0.3;
  return scenario;
}

void speeds() {
  const auto run_by = [](Method method, std::int64_t periods) {
    Scenario scenario = quasistat(periods);
    scenario.method.method = method;
    return median_of_5([&] {
      ClockRun run(scenario, 1);
      while (run.next()) {
      }
    });
  };
  std::printf("fig. quasistat, 4.8e6 periods: %.3f s by map, ", run_by(Method::map, 4800000));
  std::printf("%.3f s by averaged2\n", run_by(Method::averaged2, 4800000));
  const double single = run_by(Method::map, 600000) / 600000;
  const double together = median_of_5([] {
                            (void)final_periods(quasistat(600000), {1, 64, 1});
                          }) /
                          64 / 600000;
  std::printf("ensemble of 64, one thread: %.1f ns per period, single runs %.1f: %.2f times\n",
              1e9 * together, 1e9 * single, single / together);
}

void ten_years() {
  Scenario scenario = quasistat(0);
  scenario.periods.reset();
  scenario.duration_s = 10 * 365.25 * 86400.0;
  scenario.drive.slow_rms = 0.02;
  scenario.drive.slow_time_s = 86400.0;
  for (const Method method : {Method::map, Method::averaged2}) {
    scenario.method.method = method;
    std::int64_t periods = 0;
    const double time = thread_seconds([&] {
      ClockRun run(scenario, 1);
      while (run.next())
        ++periods;
    });
    std::printf("ten years of T0 = 2 s, fast and slow drive, %s: %.1f s (%lld periods)\n",
                std::string(name_of(method)).c_str(), time, static_cast<long long>(periods));
  }
}

// How close the automatic choice comes to the tolerance it promised.
void automatic() {
  struct Worst {
    double ratio = 0.0, epsilon = 0.0, lambda_ratio = 0.0, amplitude = 0.0, tolerance = 0.0;
    Method method = Method::direct;
  } worst;
  int scenes = 0, averaged = 0;
  for (const double epsilon : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3})
    for (const double ratio : {1.0, 1.005, 1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0})
      for (const double amplitude : {0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 1.5, 1.9, 1.99})
        for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9})
          for (const double rms : {0.0, 0.2}) {
            Scenario scenario;
            const double phi0 = amplitude / ratio;
            const double mu = 0.5 * std::numbers::pi * epsilon * amplitude * amplitude / phi0;
            scenario.clock = {2.0, epsilon, std::min(mu, 0.9), phi0};
            scenario.start_amplitude = amplitude;
            scenario.periods = 150;
            scenario.drive.fast_rms = rms;
            scenario.method.tolerance_s = tolerance;
            ClockRun chosen(scenario, 1);
            scenario.method.method = Method::direct;
            ClockRun exact(scenario, 1);
            double error = 0.0;
            for (;;) {
              const auto a = chosen.next(), b = exact.next();
              if (a.has_value() != b.has_value()) error = INFINITY; // a stall that was missed
              if (!a || !b) break;
              error = std::max(
                  error, std::abs((a->time_s.hi - b->time_s.hi) + (a->time_s.lo - b->time_s.lo)));
            }
            ++scenes;
            const Method method = chosen.method().method;
            averaged += method == Method::averaged1 || method == Method::averaged2;
            if (error / tolerance > worst.ratio)
              worst = {error / tolerance, epsilon, ratio, amplitude, tolerance, method};
          }
  std::printf("automatic choice: %d scenes, %d by averaged equations; worst error %.2f of the "
              "tolerance (%s, epsilon %.0e, lambda/phi0 %.3f, %.3f rad, %.0e s)\n",
              scenes, averaged, worst.ratio, std::string(name_of(worst.method)).c_str(),
              worst.epsilon, worst.lambda_ratio, worst.amplitude, worst.tolerance);
}

} // namespace

int main() {
  noisy_crossings();
  speeds();
  ten_years();
  automatic();
}

// Speed of the main loops. Machines are noisy: compare ratios within one run, take medians
// (--benchmark_repetitions=9 --benchmark_report_aggregates_only=true).
#include "goingrate/dynamics/averaged.hpp"
#include "goingrate/dynamics/direct.hpp"
#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/log/reading.hpp"
#include "goingrate/log/writing.hpp"
#include "goingrate/spectra/spectrum.hpp"
#include "goingrate/spectra/stability.hpp"
#include "support/simulated.hpp"

#include <benchmark/benchmark.h>

namespace {

using namespace goingrate;

void direct_period(benchmark::State& state) {
  DirectPendulum pendulum({2.0, 2.5e-4, 2e-5, 0.03}, 0.0390886300401325);
  for (auto _ : state)
    benchmark::DoNotOptimize(pendulum.advance());
}
BENCHMARK(direct_period);

void averaged_crossing(benchmark::State& state) {
  const AveragedMotion<double> motion(2.5e-4, 4e-5, 0.03, 0.0390886 * 0.0390886);
  double t = 0.0;
  for (auto _ : state)
    benchmark::DoNotOptimize(motion.at(t += 6.28));
}
BENCHMARK(averaged_crossing);

void read_and_number(benchmark::State& state) {
  const std::string text = native_log_text(test::simulated_log(test::at_point_a(100000), 1), 12);
  for (auto _ : state)
    benchmark::DoNotOptimize(number_beats(read_log(text, "bench")));
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) * state.iterations());
}
BENCHMARK(read_and_number)->Unit(benchmark::kMillisecond);

void fit_jump(benchmark::State& state) {
  const auto data = timing_data(test::simulated_beats(test::jump_from_a_to_b(2000, 1e-5), 1));
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  for (auto _ : state)
    benchmark::DoNotOptimize(fit_clock(data, 2.0, options));
}
BENCHMARK(fit_jump)->Unit(benchmark::kMillisecond);

void oadev_octaves(benchmark::State& state) {
  RandomStream random(1, StreamPurpose::jitter);
  std::vector<double> phase(1000000);
  for (double& x : phase)
    x = 1e-6 * random.normal();
  const auto factors = octave_factors(phase.size());
  for (auto _ : state)
    benchmark::DoNotOptimize(stability_table(DeviationKind::oadev, phase, 1.0, factors));
}
BENCHMARK(oadev_octaves)->Unit(benchmark::kMillisecond);

void spectrum_of_a_prime_length(benchmark::State& state) {
  RandomStream random(1, StreamPurpose::jitter);
  std::vector<double> rate(100003);
  for (double& x : rate)
    x = random.normal();
  for (auto _ : state)
    benchmark::DoNotOptimize(welch_spectrum(rate, 1.0, {.segment = rate.size()}));
}
BENCHMARK(spectrum_of_a_prime_length)->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();

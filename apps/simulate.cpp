// goingrate simulate: a scenario becomes a log.
#include "common.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/clock/scenario.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/log/sensor.hpp"
#include "goingrate/log/writing.hpp"

#include <fmt/format.h>
#include <iterator>
#include <memory>

namespace goingrate::apps {

namespace {

struct SimulateOptions {
  std::string scenario;
  std::string output = "-";
  std::string truth;
  std::uint64_t seed = 1;
  std::vector<std::string> overrides;
};

Instant instant_of(const TwoPart<double>& time) { return Instant::from_seconds(time.hi) + time.lo; }

void append_truth(std::string& text, const Period& period) {
  fmt::format_to(std::back_inserter(text), "{},{},{:.17g},{:.17g},{:.17g},{:.17g}\n", period.cycle,
                 format_instant(instant_of(period.time_s), 17), period.period_s, period.velocity,
                 period.amplitude_rad, period.mu);
}

void run(const SimulateOptions& options, const GlobalOptions& global) {
  const Scenario scenario =
      parse_scenario(read_text(options.scenario), options.scenario, options.overrides);
  ClockRun run(scenario, options.seed);
  Sensor sensor(scenario.sensor, options.seed);
  std::string truth = "cycle,time_s,period_s,velocity,amplitude_rad,mu\n";
  sensor.see(run.last());
  while (const auto period = run.next()) {
    sensor.see(*period);
    if (!options.truth.empty()) append_truth(truth, *period);
  }
  if (run.status() != SwingStatus::crossed)
    throw NumericsError(
        fmt::format("{} after {} periods; nothing was written (--set run.periods={} "
                    "ends before)",
                    words_for(run.status()), run.last().cycle, run.last().cycle));
  write_whole_files({{options.truth, truth},
                     {options.output, native_log_text(sensor.log(scenario.clock.nominal_period_s),
                                                      decimals_for(scenario.sensor))}});
  say(global, fmt::format("{} periods by {}: {}", run.last().cycle, name_of(run.method().method),
                          run.method().reason));
  if (run.fallbacks() > 0)
    say(global, fmt::format("{} of them outside the map, by direct integration", run.fallbacks()));
}

} // namespace

void add_simulate(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand("simulate", "a scenario becomes a log of crossings");
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("scenario", options->scenario, "scenario in TOML; '-' is standard input")
      ->required();
  command->add_option("-o,--output", options->output,
                      "the log to write; standard output if not given");
  command->add_option("--truth", options->truth, "also write the true state, one row a period");
  command->add_option("--seed", options->seed, "of the random streams")->capture_default_str();
  command->add_option("--set", options->overrides, "override a key of the scenario: clock.mu=3e-5")
      ->allow_extra_args(false);
  command->footer("Example:\n  goingrate simulate data/scenarios/jump.toml -o jump.csv --seed 7");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

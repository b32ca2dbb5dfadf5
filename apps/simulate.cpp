// goingrate simulate: a scenario becomes a log.
#include "plot.hpp"
#include "progress.hpp"
#include "scenario.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/clock/scenario.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/ensemble.hpp"
#include "goingrate/log/sensor.hpp"
#include "goingrate/log/writing.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <iterator>
#include <memory>

namespace goingrate::apps {

namespace {

struct SimulateOptions {
  ScenarioOptions scenario;
  std::string output = "-";
  std::string truth, plot;
  std::uint64_t seed = 1;
  std::size_t realisations = 1;
  std::size_t threads = 0;
};

Instant instant_of(const TwoPart<double>& time) { return Instant::from_seconds(time.hi) + time.lo; }

void append_truth(std::string& text, const Period& period) {
  fmt::format_to(std::back_inserter(text), "{},{},{:.17g},{:.17g},{:.17g},{:.17g}\n", period.cycle,
                 format_instant(instant_of(period.time_s), 17), period.period_s, period.velocity,
                 period.amplitude_rad, period.mu);
}

// The log and the truth of one realisation, written as they grow.
class Writer {
public:
  Writer(const Scenario& scenario, const Period& start, std::uint64_t seed,
         const std::string& log_path, const std::string& truth_path)
      : columns_(native_columns(scenario.sensor, scenario.clock)),
        sensor_(scenario, seed) {
    files_.emplace_back(log_path);
    files_.emplace_back(truth_path);
    files_[0].text() = native_log_header(columns_);
    if (files_[1].wanted()) files_[1].text() = "cycle,time_s,period_s,velocity,amplitude_rad,mu\n";
    sensor_.see(start);
  }

  void see(const Period& period) {
    sensor_.see(period);
    if (period.cycle % 1024 == 0) take(false);
    if (files_[1].wanted()) append_truth(files_[1].text(), period);
    files_[1].flush_if_large();
  }

  // Puts all on disk; nothing is replaced yet.
  void finish() {
    take(true);
    for (StreamedFile& file : files_)
      file.finish();
  }
  void add_files(std::vector<StreamedFile*>& files) {
    for (StreamedFile& file : files_)
      files.push_back(&file);
  }

private:
  void take(bool at_end) {
    for (const SensedEvent& event : sensor_.take(at_end))
      append_native_line(files_[0].text(), event, columns_);
    files_[0].flush_if_large();
  }

  NativeColumns columns_;
  Sensor sensor_;
  std::vector<StreamedFile> files_; // log, truth
};

// jump.csv becomes jump-07.csv.
std::string numbered(const std::string& path, std::size_t k, std::size_t count) {
  if (path.empty() || count == 1) return path;
  const std::filesystem::path name(path);
  const auto digits = static_cast<int>(fmt::format("{}", count - 1).size());
  return (name.parent_path() /
          fmt::format("{}-{:0{}}{}", name.stem().string(), k, digits, name.extension().string()))
      .string();
}

// Each realisation has a file of its own, named after the one that was given.
void check_can_be_numbered(const std::string& option, const std::string& path) {
  std::error_code not_there;
  const bool taken = std::filesystem::exists(path, not_there) &&
                     !std::filesystem::is_regular_file(path, not_there);
  const bool nameless = !path.empty() && !std::filesystem::path(path).has_filename();
  if (path == "-" || taken || nameless)
    throw ArgumentError(option, path,
                        "the name of a file, which gets a number for each realisation: log.csv "
                        "becomes log-0.csv, log-1.csv and on");
}

void check_going(SwingStatus status, const Period& last) {
  if (status != SwingStatus::crossed)
    throw NumericsError(
        fmt::format("{} after {} periods; nothing was written (--set run.periods={} ends the run "
                    "before that)",
                    words_for(status), last.cycle, last.cycle));
}

// The true course as a log of perfect beats.
class TrueCourse {
public:
  void see(const Period& period) {
    Beat beat = event_at(instant_of(period.time_s), Edge::up, 0, period.amplitude_rad);
    beat.cycle = period.cycle;
    data_.beats.push_back(beat);
  }

  std::vector<Figure> figures(const Scenario& scenario) {
    const double nominal_s = scenario.clock.nominal_period_s;
    data_.rate = summarise_rates(data_.beats, nominal_s);
    data_.log.has_amplitude = true;
    data_.fit.status = FitStatus::no_valid_model;
    for (const ClockEvent& event : scenario.events)
      data_.diary.changes.push_back(
          {0, event.at_s.value_or(nominal_s * static_cast<double>(event.at_period.value_or(0)))});
    return figures_named(data_, {"rate", "amplitude"});
  }

private:
  Analysis data_;
};

constexpr std::int64_t periods_between_looks = 65536; // some milliseconds of the fastest method

double share_done(const Scenario& scenario, const Period& period) {
  if (scenario.periods)
    return static_cast<double>(period.cycle) / static_cast<double>(*scenario.periods);
  return scenario.duration_s ? instant_of(period.time_s).to_double() / *scenario.duration_s : 0.0;
}

void run_single(const Scenario& scenario, const SimulateOptions& options,
                const GlobalOptions& global) {
  ClockRun run(scenario, options.seed);
  Writer writer(scenario, run.last(), options.seed, options.output, options.truth);
  StreamedFile plot(options.plot);
  TrueCourse course;
  if (plot.wanted()) course.see(run.last());
  {
    ProgressBar bar(global.quiet, "simulating");
    while (const auto period = run.next()) {
      writer.see(*period);
      if (plot.wanted()) course.see(*period);
      if (period->cycle % periods_between_looks == 0) bar(share_done(scenario, *period));
    }
  }
  check_going(run.status(), run.last());
  writer.finish();
  if (plot.wanted()) plot.text() = plotted(options.plot, course.figures(scenario));
  std::vector<StreamedFile*> files{&plot};
  writer.add_files(files);
  commit_all(files);
  say(global, fmt::format("{} periods by {}: {}", run.last().cycle, name_of(run.method().method),
                          run.method().reason));
  if (run.fallbacks() > 0)
    say(global, fmt::format("{} of them outside the map, by direct integration", run.fallbacks()));
}

void run_many(const Scenario& scenario, const SimulateOptions& options,
              const GlobalOptions& global) {
  check_can_be_numbered("output", options.output);
  check_can_be_numbered("truth", options.truth);
  const ClockRun first(scenario, options.seed);
  std::vector<Writer> writers;
  writers.reserve(options.realisations);
  constexpr std::size_t most_open_files = 64; // files that are open at a time
  ProgressBar bar(global.quiet, "simulating");
  for (std::size_t from = 0; from < options.realisations; from += most_open_files) {
    const std::size_t count = std::min(most_open_files, options.realisations - from);
    for (std::size_t k = from; k < from + count; ++k)
      writers.emplace_back(scenario, first.last(), options.seed + k,
                           numbered(options.output, k, options.realisations),
                           numbered(options.truth, k, options.realisations));
    std::vector<Period> last(count);
    const auto status = run_ensemble(scenario, {options.seed + from, count, options.threads},
                                     [&](std::size_t k, const Period& period) {
                                       last[k] = period;
                                       writers[from + k].see(period);
                                     });
    for (std::size_t k = 0; k < count; ++k) {
      check_going(status[k], last[k]);
      writers[from + k].finish();
    }
    bar(static_cast<double>(from + count) / static_cast<double>(options.realisations));
  }
  std::vector<StreamedFile*> files;
  for (Writer& writer : writers)
    writer.add_files(files);
  commit_all(files);
  say(global, fmt::format("{} realisations by {}: {}", options.realisations,
                          name_of(first.method().method), first.method().reason));
}

void run(const SimulateOptions& options, const GlobalOptions& global) {
  const Scenario scenario = read_scenario(options.scenario).scenario;
  options.realisations == 1 ? run_single(scenario, options, global)
                            : run_many(scenario, options, global);
}

} // namespace

void add_simulate(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand("simulate", "make a log of crossings from a scenario");
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("scenario", options->scenario.path, "scenario in TOML; '-' is standard input")
      ->required();
  command->add_option("-o,--output", options->output,
                      "the log to write; standard output if not given");
  command->add_option("--truth", options->truth, "also write the true state, one row per period");
  auto* plot = add_plot_option(*command, options->plot, "the true rate and amplitude");
  command->add_option("--seed", options->seed, "seed of the random streams")
      ->check(seed_range())
      ->capture_default_str();
  auto* many =
      command
          ->add_option(
              "--realisations", options->realisations,
              "number of logs: -o log.csv becomes log-0.csv, log-1.csv and so on (log-00.csv for "
              "more than ten), --truth likewise; log k is the one that --seed SEED+k gives alone")
          ->check(CLI::Range(1, 10000000))
          ->capture_default_str();
  plot->excludes(many);
  command
      ->add_option("--threads", options->threads,
                   "number of threads; 0: one per core. The results are the same")
      ->check(not_negative())
      ->capture_default_str();
  add_override_option(*command, options->scenario);
  command->footer("Example:\n  goingrate simulate data/scenarios/jump.toml -o jump.csv --seed 7");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

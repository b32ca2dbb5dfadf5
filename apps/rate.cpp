// goingrate rate: a log becomes numbered beats and rates.
#include "follow.hpp"
#include "job.hpp"
#include "plot.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/log/writing.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"

#include <memory>
#include <sstream>

namespace goingrate::apps {

namespace {

struct RateOptions {
  LogOptions log;
  std::string output;
  std::string json;
  double block_s = 0.0;
  std::int64_t running_cycles = 0;
  std::string native, phase, ticc, par, plot;
  bool follow = false;
  double alarm_s = 0.0;
};

// The table grows on disk, not in memory.
void write_table(StreamedFile& file, const RateOptions& options, const NumberedLog& loaded) {
  if (!file.wanted()) return;
  if (options.block_s > 0.0) {
    file.text() =
        block_table(block_rates(loaded.beats.beats, loaded.nominal_period_s, options.block_s));
    return;
  }
  RateTable table({loaded.nominal_period_s, loaded.log.has_amplitude, options.running_cycles,
                   loaded.beats.step, loaded.sensor.gravity_share},
                  loaded.log.columns, loaded.beats.gaps);
  file.text() = table.header();
  for (std::size_t i = 0; i < loaded.beats.beats.size(); ++i) {
    table.append(file.text(), loaded.beats.beats[i], i);
    file.flush_if_large();
  }
}

// Decimals enough to lose nothing of times as loggers write them.
constexpr int exported_decimals = 12;

void write_others(std::vector<StreamedFile>& files, const RateOptions& options, NumberedLog& loaded,
                  const RateSummary& summary) {
  const auto add = [&](const std::string& path, auto make) {
    if (path.empty()) return;
    files.emplace_back(path);
    files.back().text() = make();
  };
  add(options.json, [&] { return rate_json(loaded.log, loaded.beats, summary, loaded.sensor); });
  add(options.phase, [&] { return stable32_text(loaded.good, loaded.nominal_period_s); });
  add(options.par, [&] { return par_text(summary, loaded.beats); });
  add(options.ticc, [&] { return ticc_text(loaded.beats.beats); });
  add(options.plot, [&] {
    return plotted(options.plot, figures_named(drawn_data(loaded), {"rate", "amplitude"}));
  });
  add(options.native, [&] {
    loaded.log.nominal_period_s = loaded.nominal_period_s;
    loaded.log.events.swap(loaded.beats.beats);
    std::string text = native_log_text(loaded.log, exported_decimals);
    loaded.log.events.swap(loaded.beats.beats);
    return text;
  });
}

void run(const RateOptions& options, const GlobalOptions& global) {
  if (options.follow) return follow(options.log, options.alarm_s, global);
  NumberedLog loaded = load(options.log, global);
  const RateSummary summary = mean_rate(loaded);
  bool elsewhere = false; // standard output has another result
  for (const std::string& path :
       {options.json, options.phase, options.par, options.ticc, options.native})
    elsewhere = elsewhere || path == "-";
  const std::string table = table_output(options.output, elsewhere ? "-" : "");
  std::vector<StreamedFile> files;
  write_others(files, options, loaded, summary);
  files.emplace_back(table);
  write_table(files.back(), options, loaded);
  commit_all(files);
  std::istringstream text(rate_text(loaded.beats, summary, loaded.sensor,
                                    !loaded.log.grid || loaded.log.nominal_period_s));
  for (std::string line; std::getline(text, line);)
    say(global, line);
}

} // namespace

Job add_rate_job(CLI::App& command) {
  auto options = std::make_shared<LogOptions>();
  add_log_settings(command, *options);
  return {[options] { return *options; },
          [](NumberedLog loaded) {
            JobOutcome outcome;
            outcome.result = rate_json(loaded.log, loaded.beats, mean_rate(loaded), loaded.sensor);
            return outcome;
          }};
}

void add_rate(CLI::App& program, const GlobalOptions& global) {
  auto* command =
      program.add_subcommand("rate", "number the beats of a log; period and rate of each");
  auto options = std::make_shared<RateOptions>();
  add_log_options(*command, options->log);
  command->add_option("-o,--output", options->output,
                      "the table (CSV); standard output if not given");
  add_json_option(*command, options->json);
  auto* plot = add_plot_option(*command, options->plot, "rate, and amplitude, against time");
  command->add_option("--block", options->block_s, "rates of blocks of this many seconds instead")
      ->check(positive());
  command
      ->add_option("--running", options->running_cycles,
                   "add a column with the rate over the last N cycles")
      ->check(CLI::Range(1, 1000000000));
  constexpr const char* group = "Files for other programs";
  command->add_option("--native", options->native, "the log itself, as goingrate writes logs")
      ->group(group);
  command->add_option("--phase", options->phase, "phase data for Stable32, TimeLab, allantools")
      ->group(group);
  command->add_option("--ticc", options->ticc, "time stamps as a TAPR TICC prints them")
      ->group(group);
  command->add_option("--par", options->par, "a summary of keys and values")->group(group);
  auto* following = command->add_flag(
      "--follow", options->follow, "print each beat as it arrives, from a pipe or a growing file");
  plot->excludes(following);
  following->excludes(command->get_option("--weather"));
  command
      ->add_option("--alarm", options->alarm_s,
                   "with --follow: report when no beat has come for this many seconds; five "
                   "periods if not given")
      ->check(positive())
      ->needs(following);
  command->footer("Example:\n  goingrate rate data/logs/jump.csv -o jump-rate.csv");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

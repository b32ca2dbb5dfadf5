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
#include <optional>
#include <sstream>
#include <utility>

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

// Writes the rows of each part of a log as soon as they are known: the table grows on disk, not in
// memory.
class TableWriter {
public:
  TableWriter(std::string path, const RateOptions& options)
      : path_(std::move(path)), options_(options) {}

  void add(const LogPart& part) {
    StreamedFile& file = this->file();
    if (!file.wanted()) return;
    const NumberedLog& log = part.log;
    if (!table_) {
      table_.emplace(RateTable::Options{log.nominal_period_s, log.log.has_amplitude,
                                        options_.running_cycles, log.beats.step,
                                        log.sensor.gravity_share},
                     log.log.columns, log.beats.gaps);
      file.text() = table_->header();
    }
    table_->go_on(log.log.columns, log.beats.gaps);
    for (std::size_t i = part.first; i < part.end; ++i) {
      table_->append(file.text(), log.beats.beats[i], i);
      file.flush_if_large();
    }
  }

  // Opened when it is first asked for: by then it is known which files are read, and it cannot be
  // one of them.
  StreamedFile& file() {
    if (!file_) file_.emplace(path_);
    return *file_;
  }

private:
  std::string path_;
  const RateOptions& options_;
  std::optional<StreamedFile> file_;
  std::optional<RateTable> table_;
};

// Whether something is asked for that needs all beats at once.
bool needs_all_beats(const RateOptions& options) {
  return options.block_s > 0.0 || !options.native.empty() || !options.phase.empty() ||
         !options.ticc.empty() || !options.plot.empty();
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
  bool elsewhere = false; // standard output has another result
  for (const std::string& path :
       {options.json, options.phase, options.par, options.ticc, options.native})
    elsewhere = elsewhere || path == "-";
  const std::string table = table_output(options.output, elsewhere ? "-" : "");
  LoadRequest request = load_request(options.log);
  if (!needs_all_beats(options)) {
    constexpr std::size_t most_for_a_mean = 1 << 20; // tell a mean rate as well as all do
    request.part_events = most_events_at_once;
    request.most_beats = most_for_a_mean;
  }
  TableWriter rows(table, options);
  LogVisitor visit;
  if (!(options.block_s > 0.0)) visit = [&](const LogPart& part) { rows.add(part); };
  NumberedLog loaded = load(std::move(request), global, visit);
  const RateSummary summary = mean_rate(loaded);
  if (options.block_s > 0.0 && rows.file().wanted())
    rows.file().text() =
        block_table(block_rates(loaded.beats.beats, loaded.nominal_period_s, options.block_s));
  std::vector<StreamedFile> files;
  write_others(files, options, loaded, summary);
  files.push_back(std::move(rows.file()));
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

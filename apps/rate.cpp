// goingrate rate: a log becomes numbered beats and rates.
#include "common.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"

#include <memory>

namespace goingrate::apps {

namespace {

struct RateOptions {
  LogOptions log;
  std::string output;
  std::string json;
};

void run(const RateOptions& options, const GlobalOptions& global) {
  const NumberedLog loaded = load(options.log, global);
  const RateSummary summary = summarise_rates(loaded.good, loaded.nominal_period_s);
  const std::string table = table_output(options.output, options.json);
  write_whole_files({{options.json, rate_json(loaded.log, loaded.beats, summary)},
                     {table, rate_table(loaded.beats, loaded.nominal_period_s)}});
  say(global, rate_text(loaded.beats, summary));
}

} // namespace

void add_rate(CLI::App& program, const GlobalOptions& global) {
  auto* command =
      program.add_subcommand("rate", "number the beats of a log; period and rate of each");
  auto options = std::make_shared<RateOptions>();
  add_log_options(*command, options->log);
  command->add_option("-o,--output", options->output,
                      "the table (CSV); standard output if not given");
  add_json_option(*command, options->json);
  command->footer("Example:\n  goingrate rate data/logs/jump.csv -o jump-rate.csv");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

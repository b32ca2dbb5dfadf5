// goingrate compare: several clocks beside each other.
#include "common.hpp"
#include "plot.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/report/compare_report.hpp"

#include <memory>
#include <vector>

namespace goingrate::apps {

namespace {

struct CompareCommand {
  LogOptions log;
  std::vector<std::string> paths; // one clock each
  std::string output, rates, json, plot;
};

void run(const CompareCommand& options, const GlobalOptions& global) {
  if (options.paths.size() < 2)
    throw UsageError("compare needs the logs of two clocks or more; found one");
  check_writable({options.output, options.rates, options.json, options.plot});
  std::vector<NumberedLog> logs;
  for (const std::string& path : options.paths) {
    LogOptions one = options.log;
    one.paths = {path};
    logs.push_back(load(one, global));
  }
  const Comparison comparison = compare(logs);
  if (logs.front().log.origin == TimeOrigin::none)
    say(global, "assumed: the logs have no dates; their times count from one moment, as those of "
                "recordings do that were begun together");
  Files files{{options.json, compare_json(comparison)},
              {table_output(options.output, options.json), compare_text(comparison)}};
  if (!options.rates.empty()) files.emplace_back(options.rates, compare_table(comparison));
  if (!options.plot.empty())
    files.emplace_back(options.plot, plotted(options.plot, compare_figures(comparison)));
  write_whole_files(files);
}

} // namespace

void add_compare(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand(
      "compare", "several clocks: rates, and deviations of each, of differences and of each alone");
  auto options = std::make_shared<CompareCommand>();
  command
      ->add_option(
          "logs", options->paths,
          "the logs of two or more clocks over the same time, one log for each clock; a folder "
          "or a ZIP is one log")
      ->required();
  add_log_settings(*command, options->log);
  command->add_option("-o,--output", options->output, "the tables; standard output if not given");
  command->add_option("--rates", options->rates, "write the rates on one time axis as CSV");
  add_json_option(*command, options->json);
  add_plot_option(*command, options->plot, "rates and deviations");
  command->footer("Three or more clocks give the deviation of each alone (three-cornered hat).\n"
                  "Example:\n  goingrate compare data/logs/jump.csv data/logs/interruption.csv");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

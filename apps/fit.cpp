// goingrate fit: the parameters of the clock, with what the log cannot tell.
#include "common.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"

#include <memory>

namespace goingrate::apps {

namespace {

struct FitCommand {
  LogOptions log;
  ModelOptions model;
  std::string output;
  std::string json;
};

void run(const FitCommand& options, const GlobalOptions& global) {
  const NumberedLog loaded = load(options.log, global);
  const FitSummary fit = fit_clock(timing_data(loaded.good), loaded.nominal_period_s,
                                   fit_options(options.model, loaded, global));
  if (fit.status != FitStatus::converged) throw NumericsError("no fit: " + fit.termination);
  write_whole_files(
      {{options.json, fit_json(fit)}, {table_output(options.output, options.json), fit_text(fit)}});
}

} // namespace

void add_fit(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand("fit", "friction, drive and escapement angle from a log");
  auto options = std::make_shared<FitCommand>();
  add_log_options(*command, options->log);
  add_model_options(*command, options->model);
  command->add_option("-o,--output", options->output, "the text; standard output if not given");
  add_json_option(*command, options->json);
  command->footer("Example:\n  goingrate fit data/logs/jump.csv --fix T0=2 --event 150:mu");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

// goingrate fit: the parameters of the clock, with what the log cannot tell.
#include "exit_code.hpp"
#include "job.hpp"
#include "plot.hpp"
#include "progress.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/drive/drive_history.hpp"
#include "goingrate/fit/par_file.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"

#include <memory>

namespace goingrate::apps {

namespace {

struct FitCommand {
  LogOptions log;
  ModelOptions model;
  std::string output;
  std::string json, par, latex, csv, drive, plot;
};

// The table goes to standard output unless another result is asked for there.
std::string text_output(const FitCommand& options) {
  const bool elsewhere = options.json == "-" || options.par == "-" || options.latex == "-" ||
                         options.csv == "-" || options.drive == "-";
  return table_output(options.output, elsewhere ? "-" : "");
}

// The history of the drive; nothing to write if it was not asked for.
std::string drive_output(const FitCommand& options, const FitSummary& fit, const TimingData& data) {
  if (options.drive.empty()) return "";
  const auto model = drive_model(fit, data);
  const auto history = model ? drive_history(data, *model) : std::nullopt;
  if (!history)
    throw NumericsError("no history of the drive: it takes a known friction (--fix epsilon=VALUE) "
                        "and amplitudes or a clock that the log determines");
  return drive_table(*history);
}

std::string plot_of(const FitCommand& options, const NumberedLog& loaded, const FitSummary& fit) {
  if (options.plot.empty()) return {};
  Analysis data = drawn_data(loaded);
  data.fit = fit;
  return plotted(options.plot,
                 figures_named(data, {"rate", "amplitude", "time-residual", "amplitude-residual",
                                      "period-amplitude", "q-amplitude"}));
}

JobOutcome job_result(const FitCommand& options, const NumberedLog& loaded) {
  FitSummary fit = fit_clock(fit_data(loaded), loaded.nominal_period_s,
                             fit_options(searching(fit_request(options.model)), loaded));
  if (!fit.has_result()) throw NumericsError("no fit: " + fit.termination);
  name_options(fit);
  JobOutcome outcome;
  outcome.result = fit_json(fit);
  if (fit.status != FitStatus::stopped_early) return outcome;
  outcome.exit_code = no_result;
  outcome.message = "no fit: " + fit.termination;
  return outcome;
}

void run(const FitCommand& options, const GlobalOptions& global) {
  check_writable({options.json, options.par, options.latex, options.csv, options.plot,
                  options.drive, text_output(options)});
  const NumberedLog loaded = load(with_held_share(options.log, options.model), global);
  const FitRequest request = fit_request(options.model);
  const FitOptions asked = fit_options(searching(request), loaded);
  const TimingData data = fit_data(loaded);
  FitSummary fit = [&] {
    StepLine now(global.quiet, "fitting the model");
    return fit_clock(data, loaded.nominal_period_s, asked, std::ref(now));
  }();
  if (finds_events(request)) tell_events(fit.events, loaded.good, global);
  if (!fit.has_result()) throw NumericsError("no fit: " + fit.termination);
  name_options(fit);
  write_whole_files({{options.json, fit_json(fit)},
                     {options.par, par_text(fit, asked, loaded.good.front().cycle)},
                     {options.latex, fit_latex(fit)},
                     {options.csv, fit_csv(fit)},
                     {options.plot, plot_of(options, loaded, fit)},
                     {options.drive, drive_output(options, fit, data)},
                     {text_output(options), fit_text(fit)}});
  if (fit.status == FitStatus::stopped_early) throw NumericsError("no fit: " + fit.termination);
}

} // namespace

Job add_fit_job(CLI::App& command) {
  auto options = std::make_shared<FitCommand>();
  add_log_settings(command, options->log);
  add_model_options(command, options->model);
  return {[options] { return with_held_share(options->log, options->model); },
          [options](NumberedLog loaded) { return job_result(*options, loaded); }};
}

void add_fit(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand("fit", "friction, drive and escapement angle from a log");
  auto options = std::make_shared<FitCommand>();
  add_log_options(*command, options->log);
  add_model_options(*command, options->model);
  command->add_option("-o,--output", options->output, "the text; standard output if not given");
  add_json_option(*command, options->json);
  command->add_option("--par", options->par,
                      "write the fit as a file to edit and to feed back with --from");
  command->add_option("--latex", options->latex,
                      "write the table of parameters as LaTeX (needs the package booktabs)");
  command->add_option("--csv", options->csv,
                      "write the table of parameters as CSV: name,value,sigma,low68,high68,low95,"
                      "high95,unit,status");
  add_plot_option(*command, options->plot, "rate, amplitude with the fit, and residuals");
  command->add_option("--drive", options->drive,
                      "write the drive as it went, mu(t)/mu0, as CSV: time_s,relative_drive,sigma");
  command->footer("Example:\n  goingrate fit data/logs/jump.csv --fix T0=2 --event 150:mu");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

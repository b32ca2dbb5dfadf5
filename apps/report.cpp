// goingrate report: everything about one log.
#include "job.hpp"
#include "plot.hpp"
#include "progress.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/report.hpp"
#include "goingrate/report/tables.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <memory>

namespace goingrate::apps {

namespace {

struct ReportCommand {
  LogOptions log;
  ModelOptions model;
  std::string output;
  std::string plot, figures, tables;
  std::string json;
  std::string diary, diary_output;
  double nut_pitch_mm = 0.0, pendulum_length_m = 0.0; // 0: not given
};

AnalysisRequest request_of(const ReportCommand& options, const NumberedLog& loaded) {
  AnalysisRequest request;
  const FitRequest fit = fit_request(options.model);
  request.fit = fit_options(fit, loaded);
  request.finds_events = finds_events(fit);
  if (!options.diary.empty()) request.logbook = read_logbook(options.diary);
  if (options.nut_pitch_mm > 0.0) request.nut_pitch_m = 1e-3 * options.nut_pitch_mm;
  if (options.pendulum_length_m > 0.0) request.rod_length_m = options.pendulum_length_m;
  return request;
}

// Parts of a report that have no place in a line: profiles, which only figures show, and the
// spectrum's arrays, which are longer than all the rest.
JobOutcome job_result(const ReportCommand& options, NumberedLog loaded) {
  AnalysisRequest request = request_of(options, loaded);
  request.traces_profiles = false;
  Analysis data = analyse(std::move(loaded), request);
  name_options(data.fit);
  data.drive.rate_spectrum.reset();
  JobOutcome outcome;
  outcome.result = report_json(data);
  return outcome;
}

Analysis analysis_of(const ReportCommand& options, const GlobalOptions& global) {
  NumberedLog loaded = load(with_held_share(options.log, options.model), global);
  AnalysisRequest request = request_of(options, loaded);
  StepLine line(global.quiet, "numbering the beats");
  request.now = [&](std::string_view what) { line(what); };
  Analysis data = analyse(std::move(loaded), request);
  if (request.finds_events) tell_events(data.fit.events, data.beats, global);
  return data;
}

// Named after the log: a file without its ending, or a folder.
std::string page_name(const std::string& log) {
  if (log == "-") return "report.html";
  std::filesystem::path path = std::filesystem::absolute(log).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  return (std::filesystem::is_directory(path) ? path.filename() : path.stem()).string() + ".html";
}

void add_figures(const std::string& folder, const Analysis& data, const GlobalOptions& global,
                 Files& files) {
  {
    const StepLine now(global.quiet, "drawing the figures");
    for (const Figure& figure : report_figures(data))
      add_figure(folder, figure.id, figure, files);
  }
  tell_of_missing_gnuplot(global);
}

void add_tables(const std::string& folder, const Analysis& data, Files& files) {
  files.emplace_back(inside(folder, "rates.csv"),
                     rate_table(data.numbered, data.rate.nominal_period_s));
  files.emplace_back(inside(folder, "parameters.csv"), fit_csv(data.fit));
  files.emplace_back(inside(folder, "parameters.tex"), fit_latex(data.fit));
  files.emplace_back(inside(folder, "deviation.txt"), deviation_text(data.deviation));
  if (data.drive.rate_spectrum)
    files.emplace_back(inside(folder, "spectrum.csv"), spectrum_table(data.drive));
  if (data.history) files.emplace_back(inside(folder, "drive.csv"), drive_table(*data.history));
}

void run(const ReportCommand& options, const GlobalOptions& global) {
  const std::string page =
      options.output.empty() ? page_name(options.log.paths.front()) : options.output;
  check_writable({options.json, page, options.plot, options.diary_output});
  Analysis data = analysis_of(options, global);
  name_options(data.fit);
  if (options.nut_pitch_mm > 0.0 && !data.nut)
    say(global, data.rate.nominal_is_known
                    ? "no turns of the rating nut: events so far apart are those of a wheel; give "
                      "the length of the pendulum (--pendulum-length)"
                    : "no turns of the rating nut: the rate takes a nominal period "
                      "(--nominal-period)");
  const bool talk = options.json != "-" && page != "-";
  Files files{{options.json, report_json(data)},
              {page, report_html(data)},
              {talk ? "-" : "", report_text(data)}};
  if (!options.plot.empty())
    files.emplace_back(
        options.plot,
        plotted(options.plot,
                figures_named(data, {"rate", "amplitude", "time-residual", "amplitude-residual",
                                     "spectrum", "deviation"})));
  if (!options.figures.empty()) add_figures(options.figures, data, global, files);
  if (!options.tables.empty()) add_tables(options.tables, data, files);
  if (!options.diary_output.empty())
    files.emplace_back(options.diary_output, logbook_text(findings_of(data)));
  write_whole_files(files);
  if (page != "-")
    say(global, "the page is " + std::filesystem::absolute(page).lexically_normal().string());
}

// What the analysis depends on.
void add_settings(CLI::App& command, ReportCommand& options) {
  add_model_options(command, options.model);
  command.add_option("--diary", options.diary,
                     "what was done to the clock: CSV with time,what,value,sigma,note; see help "
                     "diary");
  auto* pitch = command
                    .add_option("--nut-pitch", options.nut_pitch_mm,
                                "mm by which a turn of the rating nut moves the bob: the report "
                                "says how many turns bring the rate to zero")
                    ->check(positive());
  command
      .add_option("--pendulum-length", options.pendulum_length_m,
                  "length of the pendulum, m, for --nut-pitch; that of a mathematical pendulum of "
                  "the same period if not given")
      ->check(positive())
      ->needs(pitch);
}

} // namespace

Job add_report_job(CLI::App& command) {
  auto options = std::make_shared<ReportCommand>();
  add_log_settings(command, options->log);
  add_settings(command, *options);
  return {[options] { return with_held_share(options->log, options->model); },
          [options](NumberedLog loaded) { return job_result(*options, std::move(loaded)); }};
}

void add_report(CLI::App& program, const GlobalOptions& global) {
  auto* command =
      program.add_subcommand("report", "every analysis of one log: a summary and an HTML page");
  auto options = std::make_shared<ReportCommand>();
  add_log_options(*command, options->log);
  add_settings(*command, *options);
  command->add_option("-o,--output", options->output,
                      "the HTML page; if not given, the log's name with .html, in this folder");
  add_plot_option(*command, options->plot,
                  "rate, amplitude, residuals, spectrum and deviation in one figure");
  command->add_option("--figures", options->figures,
                      "folder for every figure as SVG, PDF, PNG, gnuplot script and CSV");
  command->add_option("--tables", options->tables,
                      "folder for rates, parameters (CSV, LaTeX), spectrum, deviation, drive");
  add_json_option(*command, options->json);
  command->add_option("--diary-out", options->diary_output,
                      "write the changes that the log shows, in the format of --diary");
  command->footer("If only the fit has no result, the report says so and exits 0 (`fit` exits 4).\n"
                  "Example:\n  goingrate report data/logs/jump.csv -o jump.html");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

// goingrate report: everything about one log.
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
  double nut_pitch_mm = 0.0, pendulum_length_m = 0.0; // 0: not given
};

std::optional<NutTurns> nut_turns(const ReportCommand& options, const RateSummary& rate,
                                  const GlobalOptions& global) {
  if (options.nut_pitch_mm == 0.0) return std::nullopt;
  if (!rate.nominal_is_known) {
    say(global, "no turns of the rating nut: the rate takes a nominal period (--nominal-period)");
    return std::nullopt;
  }
  const RatingNut nut{1e-3 * options.nut_pitch_mm,
                      options.pendulum_length_m > 0.0 ? options.pendulum_length_m
                                                      : mathematical_length(rate.nominal_period_s)};
  return turns_to_zero_rate(nut, rate.rate_excess, rate.rate_excess_sigma);
}

// Through an interruption, and as long again after it, the lateness stands still: what shook the
// clock then is told by the diary.
void level_interruptions(const Diary& diary, TimingData& data) {
  constexpr double before_s = 30.0;
  for (const Interruption& event : diary.interruptions) {
    const double from = event.begin.at_s - before_s;
    const double to = 2.0 * event.end.at_s - event.begin.at_s;
    double held = 0.0, taken_off = 0.0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      const double late = data.lateness_s[i];
      if (data.elapsed_s[i] < from) {
        held = late;
      } else if (data.elapsed_s[i] <= to) {
        data.lateness_s[i] = held;
        taken_off = late - held;
      } else {
        data.lateness_s[i] -= taken_off;
      }
    }
  }
}

ReportData gather(const ReportCommand& options, const GlobalOptions& global) {
  NumberedLog loaded = load(options.log, global);
  ReportData data;
  data.rate = summarise_rates(loaded.good, loaded.nominal_period_s);
  data.rate.nominal_is_known = loaded.nominal_is_known;
  data.nut = nut_turns(options, data.rate, global);
  data.diary = keep_diary(loaded.good, loaded.nominal_period_s);
  const TimingData times = fit_data(loaded);
  FitOptions asked = fit_options(options.model, loaded, global);
  asked.profiles = true;
  StepLine now(global.quiet, "fitting the model");
  data.fit = fit_clock(times, loaded.nominal_period_s, asked);
  now("looking at temperature and pressure");
  data.covariates = covariate_effects(times);
  now("spectrum of the rate, fast and slow drive");
  data.drive = analyse_drive(loaded.good, loaded.nominal_period_s, data.fit);
  now("the drive as it went");
  if (const auto model = drive_model(data.fit, times)) data.history = drive_history(times, *model);
  now("likely causes");
  const double missed = 1.0 - static_cast<double>(times.size()) / (times.cycle.back() + 1.0);
  // What the diary tells and the fit follows need not be suspected again.
  TimingData unexplained = times;
  const bool told = !data.diary.changes.empty() || !data.diary.interruptions.empty();
  if (told && data.fit.residual_s.size() == times.size())
    unexplained.lateness_s = data.fit.residual_s;
  level_interruptions(data.diary, unexplained);
  data.suspicions = diagnose({&unexplained, loaded.nominal_period_s, missed, data.drive.lines});
  now("stability");
  const PhaseSeries phase = phase_series(loaded);
  data.deviation = stability_table(DeviationKind::oadev, phase.phase_s, phase.tau0_s,
                                   octave_factors(phase.phase_s.size()));
  data.beats.assign(loaded.good.begin(), loaded.good.end());
  data.log = std::move(loaded.log);
  data.numbered = std::move(loaded.beats);
  return data;
}

std::string page_beside(const std::string& log) {
  return log == "-" ? "report.html" : std::filesystem::path(log).stem().string() + ".html";
}

void add_figures(const std::string& folder, const ReportData& data, const GlobalOptions& global,
                 Files& files) {
  {
    const StepLine now(global.quiet, "drawing the figures");
    for (const Figure& figure : report_figures(data))
      add_figure(folder, figure.id, figure, files);
  }
  tell_of_missing_gnuplot(global);
}

void add_tables(const std::string& folder, const ReportData& data, Files& files) {
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
  const ReportData data = gather(options, global);
  const std::string page = options.output.empty() ? page_beside(options.log.path) : options.output;
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
  write_whole_files(files);
  if (page != "-") say(global, "the page is " + std::filesystem::absolute(page).string());
}

} // namespace

void add_report(CLI::App& program, const GlobalOptions& global) {
  auto* command =
      program.add_subcommand("report", "all of it on one log: a summary and an HTML page");
  auto options = std::make_shared<ReportCommand>();
  options->model.finds_events = true;
  add_log_options(*command, options->log);
  add_model_options(*command, options->model);
  command->add_option("-o,--output", options->output,
                      "the HTML page; if not given, the log's name with .html, in this folder");
  add_plot_option(*command, options->plot,
                  "rate, amplitude, residuals, spectrum and deviation in one figure");
  command->add_option("--figures", options->figures,
                      "folder for every figure as SVG, PDF, PNG, a script for gnuplot, and CSV");
  command->add_option("--tables", options->tables,
                      "folder for rates, parameters (CSV, LaTeX), spectrum, deviation, drive");
  auto* pitch = command
                    ->add_option("--nut-pitch", options->nut_pitch_mm,
                                 "mm that a turn of the rating nut moves the bob: says how many "
                                 "turns bring the rate to zero")
                    ->check(positive());
  command
      ->add_option("--pendulum-length", options->pendulum_length_m,
                   "m, for the nut; that of a mathematical pendulum if not given")
      ->check(positive())
      ->needs(pitch);
  add_json_option(*command, options->json);
  command->footer("If the fit alone has no result, the report says so in its place and exits 0\n"
                  "(`fit` exits 4).\n"
                  "Example:\n  goingrate report data/logs/jump.csv -o jump.html");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

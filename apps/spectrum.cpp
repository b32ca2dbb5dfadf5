// goingrate spectrum: the spectrum of the rate, and fast against slow drive.
#include "plot.hpp"
#include "progress.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"
#include "goingrate/spectra/multitaper.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <memory>

namespace goingrate::apps {

namespace {

struct SpectrumCommand {
  LogOptions log;
  ModelOptions model;
  double split_hz = 0.0;
  std::string train;
  double fold_s = 0.0;
  std::size_t tapers = 0;
  std::string gapped_output;
  std::string against, coherence_output;
  std::string fold_output;
  std::string output;
  std::string json, plot;
};

std::vector<ExpectedPeriod> expected_periods(const SpectrumCommand& options,
                                             const NumberedLog& loaded) {
  std::vector<ExpectedPeriod> expected;
  if (!options.train.empty()) {
    std::vector<int> teeth;
    for (const double number : numbers_in("train", options.train)) {
      if (number != std::floor(number) || std::abs(number) > 1e6)
        throw ArgumentError("train", number, "a whole number of teeth");
      teeth.push_back(static_cast<int>(number));
    }
    expected = train_periods(teeth, loaded.nominal_period_s);
  }
  constexpr double long_log_s = 3.0 * 86400.0; // s
  if (loaded.good.back().time - loaded.good.front().time > long_log_s)
    for (const ExpectedPeriod& natural : natural_periods())
      expected.push_back(natural);
  return expected;
}

std::string fold(const SpectrumCommand& options, const DriveAnalysis& drive, double period_s) {
  if (options.fold_s == 0.0) return {};
  constexpr std::size_t most_bins = 60;
  const double values = std::ceil(options.fold_s / period_s);
  const auto bins = static_cast<std::size_t>(std::min<double>(most_bins, values));
  return profile_table(folded(drive.rates, period_s, options.fold_s, bins));
}

// Cycles from one value of the rate to the next.
std::int64_t step_of(const DriveAnalysis& drive, const NumberedLog& loaded) {
  return std::llround(drive.interval_s / loaded.nominal_period_s);
}

// The series that the rate is compared with, one value for each of its; an unknown value repeats
// the one before.
std::vector<double> cause_of(const SpectrumCommand& options, const NumberedLog& loaded,
                             std::int64_t step) {
  const TimingData data = fit_data(loaded);
  const auto term = std::find_if(data.terms.begin(), data.terms.end(),
                                 [&](const RateTerm& t) { return t.name == options.against; });
  const bool amplitude = options.against == "amplitude" && data.has_amplitude();
  const auto place = [&](std::size_t i) {
    return static_cast<std::int64_t>(data.cycle[i] - data.cycle[0]) / step;
  };
  std::vector<double> cause;
  double known = 0.0;
  for (std::size_t i = 1; i < data.size(); ++i) {
    const double value = amplitude ? data.amplitude_rad[i]
                                   : (term->advance_s[i] - term->advance_s[i - 1]) /
                                         (data.elapsed_s[i] - data.elapsed_s[i - 1]);
    if (std::isfinite(value)) known = value;
    cause.insert(cause.end(), static_cast<std::size_t>(place(i) - place(i - 1)), known);
  }
  return cause;
}

// Before the work, so that a misspelt column costs no time.
void check_against(const SpectrumCommand& options, const NumberedLog& loaded) {
  if (options.against.empty()) return;
  const TimingData data = fit_data(loaded);
  const auto is_it = [&](const RateTerm& term) { return term.name == options.against; };
  const bool amplitude = options.against == "amplitude";
  if (amplitude ? data.has_amplitude() : std::any_of(data.terms.begin(), data.terms.end(), is_it))
    return;
  const bool both = options.against == "density";
  throw UsageError(fmt::format("--against {}: this log has no {} column", options.against,
                               both ? "temperature and pressure" : options.against));
}

std::string coherence(const SpectrumCommand& options, const NumberedLog& loaded,
                      const DriveAnalysis& drive) {
  if (options.coherence_output.empty()) return {};
  constexpr std::size_t usual_tapers = 16;
  return coherence_table(cross_spectrum(cause_of(options, loaded, step_of(drive, loaded)),
                                        drive.rates, drive.interval_s,
                                        options.tapers > 1 ? options.tapers : usual_tapers));
}

// The rate of every period that was seen whole; a missed beat leaves a gap.
std::string gapped(const SpectrumCommand& options, const NumberedLog& loaded,
                   const DriveAnalysis& drive) {
  if (options.gapped_output.empty()) return {};
  const std::int64_t step = step_of(drive, loaded);
  std::vector<double> rates;
  for (std::size_t i = 1; i < loaded.good.size(); ++i) {
    const Beat &before = loaded.good[i - 1], &beat = loaded.good[i];
    const std::int64_t from = loaded.good.front().cycle;
    const std::int64_t places = (beat.cycle - from) / step - (before.cycle - from) / step;
    rates.insert(rates.end(), static_cast<std::size_t>(places),
                 beat.cycle - before.cycle == step
                     ? drive.interval_s / (beat.time - before.time) - 1.0
                     : std::numeric_limits<double>::quiet_NaN());
  }
  return gapped_table(lomb_scargle(rates, drive.interval_s));
}

std::string plot_of(const SpectrumCommand& options, const NumberedLog& loaded,
                    const DriveAnalysis& drive) {
  if (options.plot.empty()) return {};
  Analysis data = drawn_data(loaded);
  data.drive = drive;
  return plotted(options.plot, figures_named(data, {"spectrum"}));
}

void run(const SpectrumCommand& options, const GlobalOptions& global) {
  check_writable({options.json, options.plot, options.output, options.gapped_output,
                  options.coherence_output, options.fold_output});
  const NumberedLog loaded = load(options.log, global);
  check_against(options, loaded);
  const FitRequest request = fit_request(options.model);
  const TimingData times = fit_data(loaded);
  const FitOptions asked = fit_options(searching(request), loaded);
  FitSummary fit;
  const DriveAnalysis drive = [&] {
    StepLine now(global.quiet, "fitting the model");
    fit = fit_clock(times, loaded.nominal_period_s, asked, std::ref(now));
    now("spectrum of the rate, fast and slow drive");
    const auto moved_back = without_displacements(loaded.good, times);
    return analyse_drive(moved_back ? std::span<const Beat>(*moved_back) : loaded.good,
                         loaded.nominal_period_s, fit, options.split_hz);
  }();
  if (finds_events(request)) tell_events(fit.events, loaded.good, global);
  if (!drive.rate_spectrum)
    throw NumericsError(fmt::format("{} beats are too few for a spectrum", loaded.good.size()));
  std::string text = drive_text(drive, expected_periods(options, loaded));
  std::vector<CovariateEffect> effects = covariate_effects(times);
  tell_ways(times, fit, effects);
  for (const CovariateEffect& effect : effects)
    text += covariate_text(effect) + "\n";
  const bool talk = options.json != "-" && options.output != "-" && options.fold_output != "-" &&
                    options.gapped_output != "-" && options.coherence_output != "-";
  write_whole_files({{options.json, spectrum_json(drive)},
                     {options.plot, plot_of(options, loaded, drive)},
                     {options.output, options.tapers == 0 ? spectrum_table(drive)
                                                          : tapered_table(multitaper_spectrum(
                                                                drive.rates, drive.interval_s,
                                                                options.tapers, false))},
                     {options.gapped_output, gapped(options, loaded, drive)},
                     {options.coherence_output, coherence(options, loaded, drive)},
                     {options.fold_output, fold(options, drive, drive.interval_s)},
                     {talk ? "-" : "", text}});
}

} // namespace

void add_spectrum(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand("spectrum", "spectrum of the rate; fast and slow drive");
  auto options = std::make_shared<SpectrumCommand>();
  add_log_options(*command, options->log);
  add_model_options(*command, options->model);
  command->add_option("--split", options->split_hz, "part fast from slow at this frequency (Hz)")
      ->check(positive());
  command->add_option("--train", options->train,
                      "teeth from the slowest wheel to the escape wheel (60,8,64,8,30): names the "
                      "periods found");
  auto* fold =
      command->add_option("--fold", options->fold_s, "mean course of the rate over this period (s)")
          ->check(positive());
  command->add_option("--fold-output", options->fold_output, "write that course as CSV")
      ->needs(fold);
  command->add_option("-o,--output", options->output,
                      "write the spectrum of the rate and its parts as CSV");
  add_plot_option(*command, options->plot, "the spectrum and its parts");
  command->add_option("--tapers", options->tapers,
                      "that table by so many sine tapers, with 68 % intervals, instead of one "
                      "window over all");
  command->add_option(
      "--gapped", options->gapped_output,
      "write the Lomb-Scargle periodogram of the periods seen whole, and its window");
  auto* against =
      command
          ->add_option("--against", options->against,
                       "amplitude, temperature, pressure, humidity or density (of air) of the log")
          ->check(one_of({"amplitude", "temperature", "pressure", "humidity", "density"}));
  command
      ->add_option("--coherence", options->coherence_output,
                   "write coherence, gain and phase of the rate against that column")
      ->needs(against);
  add_json_option(*command, options->json);
  command->footer("Example:\n  goingrate spectrum data/logs/noisy-drive.csv --fix T0=2 \\\n"
                  "    --fix epsilon=1.167245e-4 --fix mu=1.5e-5 --fix phi0=0.03");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

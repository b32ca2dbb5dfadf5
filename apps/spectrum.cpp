// goingrate spectrum: the spectrum of the rate, and fast against slow drive.
#include "common.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"

#include <fmt/format.h>
#include <memory>

namespace goingrate::apps {

namespace {

struct SpectrumCommand {
  LogOptions log;
  ModelOptions model;
  double split_hz = 0.0;
  std::string output;
  std::string json;
};

void run(const SpectrumCommand& options, const GlobalOptions& global) {
  const NumberedLog loaded = load(options.log, global);
  const FitSummary fit = fit_clock(fit_data(loaded), loaded.nominal_period_s,
                                   fit_options(options.model, loaded, global));
  const DriveAnalysis drive =
      analyse_drive(loaded.good, loaded.nominal_period_s, fit, options.split_hz);
  if (!drive.rate_spectrum)
    throw NumericsError(fmt::format("{} beats are too few for a spectrum", loaded.good.size()));
  const bool talk = options.json != "-" && options.output != "-";
  write_whole_files(
      {{options.json, spectrum_json(*drive.rate_spectrum, drive.response, drive.split)},
       {options.output, spectrum_table(*drive.rate_spectrum)},
       {talk ? "-" : "", split_text(drive.response, drive.split)}});
}

} // namespace

void add_spectrum(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand("spectrum", "spectrum of the rate; fast and slow drive");
  auto options = std::make_shared<SpectrumCommand>();
  add_log_options(*command, options->log);
  add_model_options(*command, options->model);
  command->add_option("--split", options->split_hz, "part fast from slow at this frequency (Hz)")
      ->check(positive());
  command->add_option("-o,--output", options->output, "write the spectrum of the rate as CSV");
  add_json_option(*command, options->json);
  command->footer("Example:\n  goingrate spectrum data/logs/noisy-drive.csv --fix T0=2 "
                  "--fix epsilon=1.167245e-4 \\\n    --fix mu=1.5e-5 --fix phi0=0.03");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

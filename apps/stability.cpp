// goingrate stability: Allan deviations and their relatives.
#include "job.hpp"
#include "plot.hpp"

#include "base/spelling.hpp"

#include "goingrate/analysis/phases.hpp"
#include "goingrate/base/atomic_file.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <utility>

namespace goingrate::apps {

namespace {

struct StabilityCommand {
  LogOptions log;
  std::string kind = "oadev";
  std::string data = "timestamps";
  std::string taus = "octave";
  std::optional<int> alpha;
  bool keep_bias = false;
  std::string output;
  std::string json, plot;
};

LogOptions log_of(const StabilityCommand& options) {
  LogOptions log = options.log;
  log.phases_will_do = true;
  if (options.data != "timestamps") {
    if (!log.format.empty() && log.format != options.data)
      throw ArgumentError("data", options.data, "the same as the format, " + log.format);
    log.format = options.data;
  }
  return log;
}

PhaseSeries load_phases(const StabilityCommand& options, const GlobalOptions& global) {
  LoadRequest request = load_request(log_of(options));
  constexpr std::size_t part_events = 1 << 22, most_beats = 1 << 10; // the beats are not needed
  request.part_events = part_events;
  request.most_beats = most_beats;
  PhaseCollector phases;
  NumberedLog loaded =
      load(std::move(request), global, [&](const LogPart& part) { phases.add(part); });
  return phases.series(std::move(loaded));
}

const std::vector<std::string> words_for_taus{"octave", "decade", "all"};

std::vector<double> averaging_times(const std::string& taus) {
  try {
    return numbers_in("taus", taus);
  } catch (const ArgumentError&) {
    throw ArgumentError("taus", taus,
                        "octave, decade, all, or numbers in seconds, such as 3,30,300" +
                            meant_instead(taus, words_for_taus));
  }
}

std::vector<std::size_t> factors_of(const std::string& taus, std::size_t points, double tau0_s,
                                    DeviationKind kind) {
  if (auto factors = factors_named(taus, points, kind)) return std::move(*factors);
  return factors_for(averaging_times(taus), points, tau0_s, kind);
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const DeviationKind kind : deviation_kinds)
    names.emplace_back(name_of(kind));
  return names;
}

std::string plot_of(const StabilityCommand& options, const DeviationTable& table) {
  if (options.plot.empty()) return {};
  Analysis data;
  data.deviation = table;
  return plotted(options.plot, figures_named(data, {"deviation"}));
}

DeviationTable table_of(const StabilityCommand& options, PhaseSeries phase) {
  if (options.log.tau0_s > 0.0) phase.tau0_s = options.log.tau0_s;
  const DeviationKind kind = *deviation_named(options.kind);
  const auto factors = factors_of(options.taus, phase.phase_s.size(), phase.tau0_s, kind);
  return stability_table(kind, phase.phase_s, phase.tau0_s, factors,
                         {.alpha = options.alpha, .remove_bias = !options.keep_bias});
}

void run(const StabilityCommand& options, const GlobalOptions& global) {
  const DeviationTable table = table_of(options, load_phases(options, global));
  const std::string text = deviation_text(table) + deviation_findings(table);
  write_whole_files({{options.json, stability_json(table)},
                     {options.plot, plot_of(options, table)},
                     {table_output(options.output, options.json), text}});
}

// What the table depends on.
void add_settings(CLI::App& command, StabilityCommand& options) {
  command
      .add_option(
          "--kind", options.kind,
          "which deviation: oadev (overlapping Allan), mdev (modified), hdev (Hadamard) ...")
      ->check(one_of(kind_names()))
      ->capture_default_str();
  command
      .add_option("--data", options.data,
                  "what the file holds: timestamps (a log), or --format phase or frequency")
      ->check(one_of({"timestamps", "phase", "frequency"}))
      ->capture_default_str();
  auto* taus = command
                   .add_option("--taus", options.taus,
                               "averaging times: octave, decade, all, or a list in seconds "
                               "(3,30,300)")
                   ->capture_default_str();
  offers(taus, words_for_taus);
  command
      .add_option("--alpha", options.alpha,
                  "noise assumed at every averaging time, 2 (jitter) to -4; identified if not "
                  "given")
      ->check(CLI::Range(-4, 2));
  command.add_flag("--no-bias", options.keep_bias,
                   "do not remove the bias of the total deviations and of theo1");
}

} // namespace

Job add_stability_job(CLI::App& command) {
  auto options = std::make_shared<StabilityCommand>();
  add_log_settings(command, options->log);
  add_settings(command, *options);
  return {[options] { return log_of(*options); },
          [options](NumberedLog loaded) {
            JobOutcome outcome;
            outcome.result = stability_json(table_of(*options, phase_series(std::move(loaded))));
            return outcome;
          }};
}

void add_stability(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand(
      "stability", "Allan deviations and related ones, of a log or of phase data");
  auto options = std::make_shared<StabilityCommand>();
  add_log_options(*command, options->log);
  add_settings(*command, *options);
  command->add_option("-o,--output", options->output, "the table; standard output if not given");
  add_json_option(*command, options->json);
  add_plot_option(*command, options->plot, "the deviation with its intervals");
  command->footer("Example:\n  goingrate stability data/logs/noisy-drive.csv --taus decade");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

// goingrate stability: Allan deviations and their relatives.
#include "plot.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <optional>

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

struct Phase {
  std::vector<double> phase_s;
  double tau0_s;
};

// Stable32 writes a gap of phase data as an exact zero; the first value may well be zero.
void mark_gaps(std::vector<double>& phase, const GlobalOptions& global) {
  std::size_t gaps = 0;
  for (std::size_t i = 1; i < phase.size(); ++i) {
    if (phase[i] != 0.0) continue;
    phase[i] = std::numeric_limits<double>::quiet_NaN();
    ++gaps;
  }
  if (gaps > 0) say(global, fmt::format("assumed: {} exact zeros are gaps", gaps));
}

Phase phase_of(const StabilityCommand& options, const GlobalOptions& global) {
  if (options.data == "timestamps") {
    const NumberedLog loaded = load(options.log, global);
    const auto error = clock_error(loaded.good, loaded.nominal_period_s);
    return {on_every_cycle(loaded.good, error),
            options.log.tau0_s > 0.0 ? options.log.tau0_s : loaded.nominal_period_s};
  }
  auto numbers = read_numbers(
      read_text(options.log.path, reading_options(options.log).unpacked_limit), options.log.path);
  double tau0_s = options.log.tau0_s;
  if (tau0_s == 0.0) {
    tau0_s = 1.0;
    say(global, "assumed: one value a second (--tau0 says otherwise)");
  }
  say(global, fmt::format("assumed: {} values of {}", numbers.size(),
                          options.data == "phase" ? "phase in seconds" : "relative frequency"));
  if (options.data == "phase") mark_gaps(numbers, global);
  if (options.data == "frequency") numbers = phase_from_frequency(numbers, tau0_s);
  return {std::move(numbers), tau0_s};
}

std::vector<std::size_t> factors_of(const std::string& taus, std::size_t points, double tau0_s,
                                    DeviationKind kind) {
  if (taus == "octave") return octave_factors(points, kind);
  if (taus == "decade") return decade_factors(points, kind);
  if (taus == "all") return all_factors(points, kind);
  return factors_for(numbers_in("taus", taus), points, tau0_s, kind);
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const DeviationKind kind : deviation_kinds)
    names.emplace_back(name_of(kind));
  return names;
}

DeviationKind kind_of(const std::string& name) {
  return *std::find_if(deviation_kinds.begin(), deviation_kinds.end(),
                       [&](DeviationKind kind) { return name_of(kind) == name; });
}

std::string plot_of(const StabilityCommand& options, const DeviationTable& table) {
  if (options.plot.empty()) return {};
  ReportData data;
  data.deviation = table;
  return plotted(options.plot, figures_named(data, {"deviation"}));
}

void run(const StabilityCommand& options, const GlobalOptions& global) {
  const Phase phase = phase_of(options, global);
  const DeviationKind kind = kind_of(options.kind);
  const auto factors = factors_of(options.taus, phase.phase_s.size(), phase.tau0_s, kind);
  const DeviationTable table =
      stability_table(kind, phase.phase_s, phase.tau0_s, factors,
                      {.alpha = options.alpha, .remove_bias = !options.keep_bias});
  const std::string text = deviation_text(table) + deviation_findings(table);
  write_whole_files({{options.json, stability_json(table)},
                     {options.plot, plot_of(options, table)},
                     {table_output(options.output, options.json), text}});
}

} // namespace

void add_stability(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand(
      "stability", "Allan deviations and their relatives, of a log or of phase data");
  auto options = std::make_shared<StabilityCommand>();
  add_log_options(*command, options->log);
  command
      ->add_option(
          "--kind", options->kind,
          "which deviation: oadev (overlapping Allan), mdev (modified), hdev (Hadamard) ...")
      ->check(CLI::IsMember(kind_names()))
      ->capture_default_str();
  command
      ->add_option("--data", options->data,
                   "what the file holds: timestamps (a log), phase (s) or frequency, one a line")
      ->check(CLI::IsMember({"timestamps", "phase", "frequency"}))
      ->capture_default_str();
  command
      ->add_option("--taus", options->taus,
                   "averaging times: octave, decade, all, or a list in seconds (3,30,300)")
      ->capture_default_str();
  command
      ->add_option("--alpha", options->alpha,
                   "noise assumed at every averaging time, 2 (jitter) to -4; else it is identified")
      ->check(CLI::Range(-4, 2));
  command->add_flag("--no-bias", options->keep_bias,
                    "leave the bias of the total deviations and of theo1 in");
  command->add_option("-o,--output", options->output, "the table; standard output if not given");
  add_json_option(*command, options->json);
  add_plot_option(*command, options->plot, "the deviation with its intervals");
  command->footer("Example:\n  goingrate stability data/logs/noisy-drive.csv --taus decade");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

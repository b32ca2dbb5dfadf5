#include "common.hpp"

#include <cmath>
#include <cstdio>
#include <fmt/format.h>

namespace goingrate::apps {

namespace {
constexpr std::size_t issues_shown = 5; // the rest is counted; `rate --json` lists all of them
}

void say(const GlobalOptions& global, std::string_view line) {
  if (!global.quiet) std::fputs(fmt::format("{}\n", line).c_str(), stderr);
}

void add_log_options(CLI::App& command, LogOptions& options) {
  command.add_option("log", options.path, "the log; '-' is standard input")->required();
  command
      .add_option("--format", options.format,
                  "read it as this format: native, timestamps (one time in s a line), clock-error "
                  "(label s, error s, amplitude mrad); found from the file if not given")
      ->check(CLI::IsMember({"native", "timestamps", "clock-error"}));
  command
      .add_option("--nominal-period", options.nominal_period_s,
                  "T0 in s, the period to compare with")
      ->check(CLI::PositiveNumber);
  command.add_flag(
      "--both-edges", options.both_edges,
      "the log holds both directions without labels; found by itself if the clock is out "
      "of beat");
  command
      .add_option("--flag-width", options.flag_width_rad,
                  "angle (rad) of a centred flag as seen from the pivot, whose leading edge gave "
                  "the times: they are moved to the vertical with each beat's amplitude")
      ->check(CLI::Range(0.0, 1.0));
  command
      .add_option("--gap-probability", options.gap_probability,
                  "split the log at a gap whose count is right with less than this probability")
      ->check(CLI::Range(0.5, 1.0))
      ->capture_default_str();
}

namespace {

LogFormat format_of(const std::string& name) {
  if (name == "native") return LogFormat::native;
  return name == "clock-error" ? LogFormat::clock_error : LogFormat::timestamps;
}

std::string split_text(const Gap& gap) {
  const std::string place = fmt::format("the log is split after cycle {}: ", gap.after_cycle);
  if (gap.kind == GapKind::step)
    return place + "the events go on displaced, as if the reference had been set; the longest part "
                   "is used";
  return place + fmt::format("about {} beats are missing, a count that is right with probability "
                             "{:.2f}{}; the longest part is used",
                             gap.length, gap.probability,
                             gap.kind == GapKind::stop ? " (the clock seems to have stopped)" : "");
}

void tell_about(const NumberedLog& loaded, const GlobalOptions& global) {
  for (const std::string& line : loaded.log.assumptions)
    say(global, "assumed: " + line);
  const auto& issues = loaded.log.issues;
  for (std::size_t i = 0; i < std::min(issues.size(), issues_shown); ++i)
    say(global, fmt::format("{}:{}:{}: {}: {}", loaded.log.source, issues[i].line, issues[i].column,
                            issues[i].found, issues[i].action));
  if (issues.size() > issues_shown)
    say(global, fmt::format("... and {} more lines with issues", issues.size() - issues_shown));
  std::size_t splits = 0;
  for (const Gap& gap : loaded.beats.gaps)
    if (!gap.bridged && ++splits <= issues_shown) say(global, split_text(gap));
  if (splits > issues_shown)
    say(global, fmt::format("... and at {} more places", splits - issues_shown));
  const double ratio = loaded.beats.typical_period_s / loaded.nominal_period_s;
  constexpr double plausible = 0.05; // no pendulum clock is off by an hour a day
  if (std::abs(ratio - 1.0) > plausible)
    say(global,
        fmt::format("warning: the mean period {:.6g} s is {:.3g} times the nominal period: is "
                    "--nominal-period right, or does the log hold both directions?",
                    loaded.beats.typical_period_s, ratio));
}

} // namespace

NumberedLog load(const LogOptions& options, const GlobalOptions& global) {
  ReadingOptions reading;
  if (!options.format.empty()) reading.format = format_of(options.format);
  if (options.nominal_period_s > 0.0) reading.nominal_period_s = options.nominal_period_s;
  NumberedLog loaded;
  loaded.log = read_log(read_text(options.path), options.path, reading);
  const bool labelled = label_alternate_edges(loaded.log, options.both_edges);
  if (loaded.log.format == LogFormat::timestamps && !labelled)
    loaded.log.assumptions.emplace_back(
        "each event is one period (--both-edges if both directions are in the log)");
  loaded.beats = number_beats(loaded.log, {options.gap_probability});
  loaded.nominal_period_s = nominal_period(loaded.log, loaded.beats, loaded.log.assumptions);
  if (options.flag_width_rad > 0.0) {
    correct_edge_to_centre(loaded.log, -0.5 * options.flag_width_rad, loaded.nominal_period_s);
    loaded.beats = number_beats(loaded.log, {options.gap_probability});
  }
  loaded.good = loaded.beats.longest_segment();
  if (loaded.good.size() < 3)
    throw NumericsError(
        fmt::format("{}: no run of three beats that could be numbered together", options.path));
  tell_about(loaded, global);
  return loaded;
}

std::string table_output(const std::string& output, const std::string& json) {
  if (!output.empty()) return output;
  return json == "-" ? "" : "-";
}

void add_json_option(CLI::App& command, std::string& path) {
  command.add_option("--json", path,
                     "write the result as JSON to this file; '-' is standard output");
}

} // namespace goingrate::apps

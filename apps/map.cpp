// goingrate map: stationary operation over friction and torque.
#include "plot.hpp"
#include "scenario.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/rate_map.hpp"
#include "goingrate/report/chart_report.hpp"
#include "goingrate/report/error_budget_report.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace goingrate::apps {

namespace {

struct MapCommand {
  double phi0 = 0.03;
  std::vector<double> epsilon{1e-5, 5e-4};
  std::vector<double> mu{1e-6, 5e-5};
  std::size_t points = 41;
  bool first_order = false;
  std::vector<std::string> solve;
  ScenarioOptions under; // the conditions under which the error limit must hold
  double after_days = 7.0;
  std::string output, json, plot;
};

RateMap map_of(const MapCommand& options) {
  return rate_map(options.phi0, log_grid(options.epsilon[0], options.epsilon[1], options.points),
                  log_grid(options.mu[0], options.mu[1], options.points),
                  options.first_order ? Equations::first_order : Equations::exact);
}

KnownPair known_pair(const std::vector<std::string>& words) {
  KnownPair known;
  for (const std::string& word : words) {
    const auto equals = word.find('=');
    const std::string name = word.substr(0, equals);
    if (equals == std::string::npos) throw ArgumentError("solve", word, "NAME=VALUE");
    const double value = numbers_in("solve", word.substr(equals + 1)).front();
    if (name == "epsilon")
      known.epsilon = value;
    else if (name == "mu")
      known.mu = value;
    else if (name == "amplitude")
      known.amplitude = value;
    else if (name == "rate_excess")
      known.rate_excess = value;
    else if (name == "rate")
      known.rate_excess = value / 86400.0;
    else
      throw ArgumentError("solve", name, "epsilon, mu, amplitude, rate (s/day) or rate_excess");
  }
  return known;
}

// Widens a range so that the value lies well inside.
void reach(std::vector<double>& ends, double value) {
  constexpr double margin_factor = 2.0;
  ends[0] = std::min(ends[0], value / margin_factor);
  ends[1] = std::max(ends[1], value * margin_factor);
}

std::string plot_of(const MapCommand& options, const std::vector<OperatingPoint>& points) {
  if (options.plot.empty()) return {};
  MapCommand around = options;
  for (const OperatingPoint& point : points) {
    reach(around.epsilon, point.epsilon);
    reach(around.mu, point.mu);
  }
  return plotted(options.plot, rate_map_figures(map_of(around), points));
}

void check_ranges(const MapCommand& options) {
  for (const auto* ends : {&options.epsilon, &options.mu})
    // Below 1e-15 nothing would show in the lifetime of a clock; above 1 the pendulum does not
    // swing.
    if (!((*ends)[0] >= 1e-15 && (*ends)[1] > (*ends)[0] && (*ends)[1] <= 1.0))
      throw ArgumentError(ends == &options.mu ? "mu" : "epsilon",
                          (*ends)[1] > (*ends)[0] && (*ends)[0] >= 1e-15 ? (*ends)[1] : (*ends)[0],
                          "two numbers from 1e-15 to 1, the smaller first");
}

void solve(const MapCommand& options) {
  const auto points =
      operating_points(known_pair(options.solve), options.phi0,
                       options.first_order ? Equations::first_order : Equations::exact);
  if (points.empty())
    throw NumericsError("no clock with this escapement angle has such an operating point");
  write_whole_files(
      {{options.json, operating_points_json(points, options.phi0)},
       {options.plot, plot_of(options, points)},
       {table_output(options.output, options.json), operating_points_text(points, options.phi0)}});
}

// The limit in "error=2", s, that the clock's time error must stay below; nothing without it.
std::optional<double> asked_error(const std::vector<std::string>& words) {
  constexpr std::string_view name = "error=";
  const bool asked = std::any_of(words.begin(), words.end(),
                                 [&](const std::string& word) { return word.starts_with(name); });
  if (!asked) return {};
  if (words.size() != 1) throw UsageError("--solve error=: takes no second condition");
  const auto numbers = numbers_in("solve", words.front().substr(name.size()));
  if (numbers.size() != 1) throw UsageError("--solve error=: give one number of seconds");
  return numbers.front();
}

void solve_error(const MapCommand& options, double most_s) {
  if (options.under.path.empty())
    throw UsageError("--solve error=: give the conditions with --under SCENARIO");
  if (!options.plot.empty()) throw UsageError("--plot cannot be used with --solve error=");
  const Scenario scenario = read_scenario(options.under).scenario;
  const double after_s = options.after_days * 86400.0;
  const ErrorBudget budget = error_budget(scenario, after_s);
  const auto needed = requirements(scenario, most_s, after_s);
  write_whole_files(
      {{options.json, error_budget_json(budget, needed, most_s)},
       {table_output(options.output, options.json), error_budget_text(budget, needed, most_s)}});
}

void run(const MapCommand& options) {
  check_ranges(options);
  check_writable({options.json, options.plot, options.output});
  if (const auto most_s = asked_error(options.solve)) return solve_error(options, *most_s);
  if (!options.under.path.empty()) throw UsageError("--under needs --solve error=SECONDS");
  if (options.solve.size() == 1)
    throw UsageError("--solve: two of epsilon=, mu=, amplitude=, rate=, rate_excess=, or error=");
  if (!options.solve.empty()) return solve(options);
  const RateMap map = map_of(options);
  write_whole_files({{options.json, rate_map_json(map)},
                     {options.plot, plotted(options.plot, rate_map_figures(map))},
                     {table_output(options.output, options.json), rate_map_table(map)}});
}

} // namespace

void add_map(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand("map", "stationary rate over friction and torque");
  auto options = std::make_shared<MapCommand>();
  command->add_option("--phi0", options->phi0, "escapement angle, rad")
      ->check(CLI::Range(1e-6, 3.0))
      ->capture_default_str();
  command->add_option("--epsilon", options->epsilon, "smallest and largest friction")->expected(2);
  command->add_option("--mu", options->mu, "smallest and largest torque")->expected(2);
  command->add_option("--points", options->points, "grid points along each axis")
      ->check(CLI::Range(2, 2000))
      ->capture_default_str();
  command->add_flag("--first-order", options->first_order,
                    "use the paper's averaged equations instead of the full equation of motion");
  auto* solve = command->add_option(
      "--solve", options->solve,
      "the operating point given by two of epsilon=, mu=, amplitude= (rad), rate= (s/day), "
      "rate_excess=; or error= (s): what the clock of --under needs for its time error to stay "
      "below this");
  offers(solve, {"epsilon=", "mu=", "amplitude=", "rate=", "rate_excess=", "error="})
      ->expected(1, 2);
  command->add_option("--under", options->under.path,
                      "scenario: the clock and the conditions of --solve error=");
  add_override_option(*command, options->under);
  command
      ->add_option("--after", options->after_days,
                   "days after which the error of --solve error= counts")
      ->check(CLI::Range(1e-3, 1e5))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "CSV; standard output if not given");
  add_json_option(*command, options->json);
  add_plot_option(*command, options->plot,
                  "the rate over friction for some torques, with the point of --solve");
  command->footer("Example:\n  goingrate map --solve amplitude=0.05 rate=0");
  command->callback([options, &global] {
    (void)global;
    run(*options);
  });
}

} // namespace goingrate::apps

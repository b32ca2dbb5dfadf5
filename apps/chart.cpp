// goingrate chart: measures the speed and accuracy of every method on this machine.
#include "plot.hpp"
#include "progress.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/dynamics/chart.hpp"
#include "goingrate/report/chart_report.hpp"

#include <fmt/format.h>
#include <memory>

namespace goingrate::apps {

namespace {

struct ChartCommand {
  std::size_t periods = 2000;
  int repetitions = 7;
  bool limits = false;
  double nominal_period_s = 2.0;
  double jitter_s = 1e-6;
  std::string scene = "C noisy";
  std::string output, json, plot;
};

void run_limits(const ChartCommand& options, const GlobalOptions& global) {
  check_writable({options.json, options.output});
  constexpr int periods = 50; // long enough to resolve a rate error of 1e-12
  say(global, fmt::format("{} periods at every point", periods));
  const auto rows = [&] {
    const StepLine now(global.quiet, "mapping where each method fails");
    return measure_limits(periods);
  }();
  write_whole_files({{options.json, limits_json(rows)},
                     {table_output(options.output, options.json), limits_text(rows)}});
}

void run(const ChartCommand& options, const GlobalOptions& global) {
  if (options.limits) return run_limits(options, global);
  check_writable({options.plot, options.json, options.output});
  const auto rows = [&] {
    const StepLine now(global.quiet, "timing every method");
    return measure_chart(chart_scenes(options.periods), chart_methods(), options.repetitions);
  }();
  write_whole_files(
      {{options.plot,
        plotted(options.plot,
                {chart_figure(rows, options.scene, options.nominal_period_s, options.jitter_s)})},
       {options.json, chart_json(rows)},
       {table_output(options.output, options.json), chart_text(rows, options.nominal_period_s)}});
}

} // namespace

void add_chart(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand(
      "chart", "speed against accuracy of every method, measured on this machine");
  auto options = std::make_shared<ChartCommand>();
  command->add_option("--periods", options->periods, "length of each scene, periods")
      ->check(CLI::Range(200, 10000000))
      ->capture_default_str();
  command
      ->add_option("--repetitions", options->repetitions,
                   "runs of each method; their median is printed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  auto* limits =
      command->add_flag("--limits", options->limits,
                        "where each method fails, over friction, amplitude and escapement angle");
  command->add_option("--nominal-period", options->nominal_period_s, "T0 of the clock, s")
      ->check(positive())
      ->capture_default_str();
  add_plot_option(*command, options->plot, "one scene")->excludes(limits);
  command->add_option("--scene", options->scene, "the scene that --plot draws")
      ->check(one_of({"C steady", "C noisy", "jump", "ring-down", "near stall", "large amplitude"}))
      ->capture_default_str();
  command
      ->add_option("--jitter", options->jitter_s, "jitter of the sensor, s: a line in the figure")
      ->check(not_negative())
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "the table; standard output if not given");
  add_json_option(*command, options->json);
  command->footer("Example:\n  goingrate chart --periods 500 --repetitions 3");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps

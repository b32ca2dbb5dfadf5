// Speed against accuracy of the methods, measured when called, on this machine.
//
// Every method runs the same scenes; its crossing times are compared with an oracle, the equation
// of motion integrated in Wide: on x86 64 bits, good to 1e-18 per period, elsewhere a double. All
// in scaled time and on one core.
#pragma once

#include "goingrate/clock/parameters.hpp"
#include "goingrate/dynamics/swing_status.hpp"

#include <functional>
#include <string>
#include <vector>

namespace goingrate {

/// A named scene: a start and, period by period, a clock and a drive factor.
struct ChartScene {
  std::string name;
  double velocity = 0.0; ///< at the start, an upward crossing
  /// The clock from a period on; the first entry is for period 0.
  struct Stretch {
    std::size_t from_period;
    ClockParameters clock;
  };
  std::vector<Stretch> stretches;
  std::vector<double> factors; ///< of the drive, one per period
};

/// The scenes of the chart, `periods` long: "C steady", "C noisy" (30 % white drive), "jump" (A to
/// B after 150 periods), "ring-down" (from 0.1 rad at epsilon 2.5e-4), "near stall" (lambda = 1.1
/// phi0), "large amplitude" (1.2 rad, epsilon 1e-3).
std::vector<ChartScene> chart_scenes(std::size_t periods);

/// The result of one method on one scene: the time of each upward crossing minus 2 pi per period.
struct ChartRun {
  SwingStatus status = SwingStatus::crossed;
  std::vector<double> lateness;
  double setup_s = 0.0;   ///< making the method for the first clock
  double running_s = 0.0; ///< all periods, without the setup
};

/// A method with its name and setting ("dt=0.03"); `run` computes a scene once.
struct ChartMethod {
  std::string name, setting;
  std::function<ChartRun(const ChartScene&)> run;
};

/// The methods of this library: rk4 (torque chosen in every stage), rk4-per-step and
/// rk4-at-switches, direct, map, averaged1 (with -lambda^2/16 and
/// with the circular error in full), averaged2.
std::vector<ChartMethod> chart_methods();

/// Runs any pendulum that has set_clock(clock) and advance(factor) -> PeriodStep over a scene.
/// `make(clock, velocity)` builds it; the time that takes is the setup. Declared here so that
/// methods from elsewhere are measured in the same way.
template <class Make> ChartRun run_scene(const ChartScene& scene, Make make);

/// One line of the chart.
struct ChartRow {
  std::string scenario, method, setting;
  SwingStatus status = SwingStatus::crossed; ///< how the method ended; not crossed: no numbers
  double ns_per_period = 0.0;                ///< median of the repetitions, without the setup
  double setup_us = 0.0;
  double max_error = 0.0; ///< largest error of a crossing time, scaled, as far as the oracle goes
};

/// Measures all methods on all scenes: medians of `repetitions` >= 1 runs each.
std::vector<ChartRow> measure_chart(const std::vector<ChartScene>& scenes,
                                    const std::vector<ChartMethod>& methods, int repetitions);

/// The rows of one scene that no other beats in both speed and accuracy, from fast to slow.
std::vector<ChartRow> chart_frontier(const std::vector<ChartRow>& rows, const std::string& scene);

/// One point of the map of limits.
struct LimitRow {
  double epsilon, ratio, amplitude; ///< ratio = lambda / phi0; amplitude lambda, rad
  SwingStatus exact;                ///< how the full equation ends within the run
  /// The result of one method at the point.
  struct Error {
    std::string method;
    SwingStatus status;
    double error; ///< of the last crossing time, relative to the nominal length of the run
  };
  std::vector<Error> errors;
  std::string breaks; ///< in words: the first of `errors` above 1e-6 or ending otherwise, and why
};

/// Runs direct, map, averaged2, both averaged1 and rk4-at-switches (dt = 0.03), in that order, for
/// `periods` periods over epsilon from 1e-6 to 0.3, lambda/phi0 from 1 to 10 and amplitudes from
/// 0.01 to 3 rad, at balance: mu = pi eps lambda^2 / (2 phi0), but at most 0.99.
std::vector<LimitRow> measure_limits(int periods);

} // namespace goingrate

#include "goingrate/dynamics/chart_run.hpp"

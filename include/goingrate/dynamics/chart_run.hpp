// run_scene() of chart.hpp, which includes this: runs and times one method on one scene.
#pragma once

#include "goingrate/base/sums.hpp"
#include "goingrate/base/thread_clock.hpp"
#include "goingrate/dynamics/chart.hpp"
#include "goingrate/dynamics/period_step.hpp"

#include <chrono>

namespace goingrate {

template <class Make> ChartRun run_scene(const ChartScene& scene, Make make) {
  using Clock = ThreadClock;
  const auto seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
  ChartRun run;
  run.lateness.resize(scene.factors.size());
  const auto begin = Clock::now();
  auto pendulum = make(scene.stretches.front().clock, scene.velocity);
  const auto made = Clock::now();
  TwoPart<double> lateness;
  std::size_t stretch = 1, i = 0;
  for (; i < scene.factors.size(); ++i) {
    if (stretch < scene.stretches.size() && scene.stretches[stretch].from_period == i)
      pendulum.set_clock(scene.stretches[stretch++].clock);
    const PeriodStep step = pendulum.advance(scene.factors[i]);
    if (step.status != SwingStatus::crossed) {
      run.status = step.status;
      break;
    }
    lateness += step.excess;
    run.lateness[i] = lateness.hi;
  }
  run.lateness.resize(i);
  run.setup_s = seconds(made - begin);
  run.running_s = seconds(Clock::now() - made);
  return run;
}

} // namespace goingrate

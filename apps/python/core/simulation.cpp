// Simulates a scenario for Python: the log, and the true state of the clock behind it.
#include "arrays.hpp"
#include "log_state.hpp"
#include "module.hpp"
#include "waiting.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/log/sensor.hpp"
#include "goingrate/log/writing.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

namespace goingrate::python {

namespace {

// The true state of the simulated clock, with one entry per period in every vector.
struct Truth {
  std::vector<std::int64_t> cycle;
  std::vector<double> time_s, period_s, velocity, amplitude_rad, mu;

  void see(const Period& period) {
    cycle.push_back(period.cycle);
    time_s.push_back(period.time_s.hi + period.time_s.lo);
    period_s.push_back(period.period_s);
    velocity.push_back(period.velocity);
    amplitude_rad.push_back(period.amplitude_rad);
    mu.push_back(period.mu);
  }
};

struct Simulated {
  std::string text; ///< the log, byte for byte as `goingrate simulate` writes it
  Truth truth;
  std::string method;
};

Simulated simulated(const Scenario& scenario, std::uint64_t seed) {
  constexpr std::int64_t periods_per_pulse = 1024; // between two checks for Ctrl-C
  ClockRun run(scenario, seed);
  Sensor sensor(scenario, seed);
  const NativeColumns columns = native_columns(scenario.sensor, scenario.clock);
  Simulated result;
  result.text = native_log_header(columns);
  const auto write = [&](bool at_end) {
    for (const SensedEvent& event : sensor.take(at_end))
      append_native_line(result.text, event, columns);
  };
  sensor.see(run.last());
  while (const auto period = run.next()) {
    sensor.see(*period);
    result.truth.see(*period);
    if (period->cycle % periods_per_pulse != 0) continue;
    write(false);
    pulse(); // lets Ctrl-C end the simulation
  }
  if (run.status() != SwingStatus::crossed)
    throw NumericsError(fmt::format("{} after {} periods (a run of {} ends before)",
                                    words_for(run.status()), run.last().cycle, run.last().cycle));
  write(true);
  result.method = fmt::format("{}: {}", name_of(run.method().method), run.method().reason);
  return result;
}

py::dict arrays_of(Truth&& truth) {
  py::dict arrays;
  arrays["cycle"] = array_of(std::move(truth.cycle));
  arrays["time_s"] = array_of(std::move(truth.time_s));
  arrays["period_s"] = array_of(std::move(truth.period_s));
  arrays["velocity"] = array_of(std::move(truth.velocity));
  arrays["amplitude_rad"] = array_of(std::move(truth.amplitude_rad));
  arrays["mu"] = array_of(std::move(truth.mu));
  return arrays;
}

py::tuple simulate(const std::string& text, const std::string& name,
                   const std::vector<std::string>& overrides, std::uint64_t seed) {
  const Scenario scenario = parse_scenario(text, name, overrides);
  // `waiting` releases Python's lock, which must be held again to make the objects below.
  Simulated result = [&] {
    const Waiting waiting{py::none()};
    return simulated(scenario, seed);
  }();
  return py::make_tuple(py::bytes(result.text), arrays_of(std::move(result.truth)), result.method);
}

} // namespace

void bind_simulation(py::module_& module) {
  module.def("simulate", &simulate, py::arg("text"), py::arg("name"), py::arg("overrides"),
             py::arg("seed"));
}

} // namespace goingrate::python

#include "goingrate/analysis/simulated_logs.hpp"

#include "goingrate/dynamics/intermittent.hpp"
#include "goingrate/log/sensor.hpp"
#include "goingrate/log/writing.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

std::string text_of(Sensor& sensor, const NativeColumns& columns) {
  std::string text = native_log_header(columns);
  for (const SensedEvent& event : sensor.take(true))
    append_native_line(text, event, columns);
  return text;
}

// Collects names and values; those that are missing or zero are left out.
class Truth {
public:
  void add(const std::string& name, std::optional<double> value) {
    if (value && *value != 0.0) known_[name] = *value;
  }
  void leave_out(const std::string& name) { known_.erase(name); }
  // Kept even if zero: that is torsion.
  void add_gravity(double share) { known_["gravity_share"] = share; }
  [[nodiscard]] std::map<std::string, double> take() { return std::move(known_); }

private:
  std::map<std::string, double> known_;
};

void add_clock(const ClockParameters& clock, Truth& truth) {
  truth.add("T0", clock.nominal_period_s);
  truth.add("epsilon", clock.epsilon);
  truth.add("quadratic_drag", clock.quadratic_drag);
  truth.add("dry_friction", clock.dry_friction);
  truth.add_gravity(clock.gravity_share);
  if (clock.escapement == Escapement::constant_torque) {
    truth.add("mu", clock.mu);
    truth.add("phi0", clock.phi0);
  }
  if (clock.escapement == Escapement::single_impulse) {
    truth.add("impulse", clock.impulse);
    truth.add("impulse_angle", clock.impulse_angle);
  }
}

// The number of periods for each one in which the escapement acts; if it waits for the amplitude,
// this follows from the motion. Nothing if it is not a single number.
std::optional<double> periods_to_an_action(const ClockParameters& clock) {
  if (const auto tooth = saw_tooth(clock)) return tooth->periods;
  if (clock.below > 0.0) return {};
  return static_cast<double>(clock.every);
}

// `clock` is the clock after the event, `rests` its periods_to_an_action.
void add_event(const ClockEvent& event, std::size_t k, const ClockParameters& clock,
               std::optional<double> rests, Truth& truth) {
  const bool rests_change = event.every || event.below;
  const auto add_drive = [&](const char* name, std::optional<double> changed, double value) {
    if (rests && (changed || (rests_change && value != 0.0)))
      truth.add(fmt::format("{}@{}", name, k), value / *rests);
  };
  const auto add = [&](const char* name, std::optional<double> value) {
    truth.add(fmt::format("{}@{}", name, k), value);
  };
  add("T0", event.nominal_period_s);
  add("epsilon", event.epsilon);
  add_drive("mu", event.mu, clock.acting_torque());
  add("phi0", event.phi0);
  add_drive("impulse", event.impulse, clock.impulse);
  add("impulse_angle", event.impulse_angle);
}

void add_noise(const Scenario& scenario, Truth& truth) {
  const SensorSettings& sensor = scenario.sensor;
  truth.add("offset", sensor.offset_rad);
  if (sensor.resolution_s == 0.0) truth.add("jitter_rms", sensor.jitter_rms_s);
  truth.add("amplitude_rms", sensor.amplitude_rms);
  const DriveVariability& drive = scenario.drive;
  if (!drive.sines.empty() || drive.series) return;
  truth.add("drive_rms", drive.fast_rms);
  truth.add("slow_rms", drive.slow_rms);
  if (drive.slow_rms > 0.0) truth.add("slow_time", drive.slow_time_s);
}

} // namespace

std::vector<SimulatedLog> SimulatedLogs::make(std::span<const std::uint64_t> seeds) {
  const NativeColumns columns = native_columns(scenario_.sensor, scenario_.clock);
  std::vector<Sensor> sensors;
  sensors.reserve(seeds.size());
  for (const std::uint64_t seed : seeds) {
    sensors.emplace_back(scenario_, seed);
    sensors.back().see(clocks_.start());
  }
  std::vector<SimulatedLog> logs(seeds.size());
  const auto status = clocks_.run(seeds, [&](std::size_t k, const Period& period) {
    sensors[k].see(period);
    logs[k].periods = period.cycle;
  });
  for (std::size_t k = 0; k < logs.size(); ++k) {
    logs[k].status = status[k];
    logs[k].text = text_of(sensors[k], columns);
  }
  return logs;
}

std::map<std::string, double> true_parameters(const Scenario& scenario) {
  Truth truth;
  const ClockParameters& clock = scenario.clock;
  const auto tooth = saw_tooth(clock);
  const auto rests = periods_to_an_action(clock);
  add_clock(with_drive_divided(clock, rests.value_or(1.0)), truth);
  if (!rests)
    for (const char* drive : {"mu", "impulse"}) // the mean is not a single number
      truth.leave_out(drive);
  Scenario exact = scenario;
  exact.method.method = Method::direct;
  const double start = ClockRun(exact, 0).start_velocity();
  // The first swing comes before an impulse, half a saw-tooth below the mean.
  truth.add("lambda0", clock.every > 1 || (tooth && !scenario.start_amplitude)
                           ? std::sqrt(start * start + energy_of_period(clock, start))
                           : start);
  ClockParameters after = clock;
  for (std::size_t k = 0; k < scenario.events.size(); ++k) {
    after = scenario.events[k].applied_to(after);
    add_event(scenario.events[k], k + 1, after, periods_to_an_action(after), truth);
  }
  add_noise(scenario, truth);
  return truth.take();
}

} // namespace goingrate

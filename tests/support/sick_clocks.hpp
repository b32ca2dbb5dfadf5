// Logs of clocks that are healthy or have a fault, for the whole analysis.
#pragma once

#include "base/scaled_time.hpp"
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/base/random.hpp"
#include "support/simulated.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

namespace goingrate::test {

/// A clock drawn from those people have: T0 0.8 to 3 s, Q 300 to 20,000, amplitudes 0.025 to 0.1
/// rad, lambda/phi0 1.4 to 4; 2 % of fast drive, jitter 20 us; every other one with amplitudes. Its
/// instruments see 2 K of daily temperature and 10 mbar of weather. `faults` have half to twice
/// their usual sizes; dates and sizes come from the seed.
struct SickClock {
  std::vector<Cause> faults;
  double days = 1.0;
  std::uint64_t seed = 1;
};

/// The same log every time: text with columns for time, amplitude (perhaps), temperature, pressure.
class Clinic {
public:
  explicit Clinic(const SickClock& clock)
      : clock_(clock), chance_(clock.seed, StreamPurpose::amplitude_noise),
        weather_(clock.seed, StreamPurpose::temperature_noise) {}

  std::string log() {
    make_scenario();
    for (const Cause fault : clock_.faults)
      put_into_scenario(fault);
    events_ = simulated_log(scenario_, clock_.seed).events;
    read_weather();
    for (const Cause fault : clock_.faults)
      put_into_times(fault);
    return text();
  }
  [[nodiscard]] bool has_amplitude() const { return has_amplitude_; }

private:
  double between(double low, double high) { return low + (high - low) * chance_.uniform(); }
  double geometric(double low, double high) {
    return low * std::pow(high / low, chance_.uniform());
  }
  double severity() { return geometric(0.5, 2.0); }

  void make_scenario() {
    const double period_s = geometric(0.8, 3.0), epsilon = 0.5 / geometric(300.0, 20000.0);
    const double amplitude = geometric(0.025, 0.1), phi0 = amplitude / geometric(1.4, 4.0);
    // The amplitude of rest to first order; the simulator settles the rest.
    const double mu = 0.25 * two_pi * epsilon * amplitude * amplitude / phi0;
    scenario_.clock = {period_s, epsilon, mu, phi0};
    scenario_.periods = static_cast<std::int64_t>(clock_.days * seconds_per_day / period_s);
    scenario_.drive.fast_rms = 0.02;
    scenario_.sensor.jitter_rms_s = 2e-5;
    has_amplitude_ = clock_.seed % 2 == 0;
    if (has_amplitude_) scenario_.sensor.amplitude_rms = 1e-3 * amplitude;
    somewhere_ = between(0.2, 0.8);
  }

  void put_into_scenario(Cause fault) {
    ClockParameters& own = scenario_.clock;
    ClockEvent event;
    event.at_period =
        static_cast<std::int64_t>(somewhere_ * static_cast<double>(*scenario_.periods));
    switch (fault) {
    case Cause::slow_drive:
      scenario_.drive.slow_rms = 0.05 * severity();
      scenario_.drive.slow_time_s = geometric(3600.0, 14400.0);
      break;
    case Cause::rough_drive:
      scenario_.drive.fast_rms = 0.3 * severity();
      break;
    case Cause::wheel:
      scenario_.drive.sines = {{0.05 * severity(), geometric(240.0, 960.0)}};
      break;
    case Cause::drive_step:
      event.mu = own.mu * (1.0 + 0.1 * severity());
      scenario_.events.push_back(event);
      break;
    case Cause::friction_step:
      event.epsilon = own.epsilon * (1.0 + 0.1 * severity());
      scenario_.events.push_back(event);
      break;
    case Cause::length_step:
      event.nominal_period_s = own.nominal_period_s * (1.0 + 5e-6 * severity());
      scenario_.events.push_back(event);
      break;
    case Cause::growing_friction: {
      const double growth = 0.1 * severity();
      for (int k = 1; k < 84; ++k) {
        ClockEvent grown;
        grown.at_period = *scenario_.periods * k / 84;
        grown.epsilon = own.epsilon * (1.0 + growth * k / 84.0);
        scenario_.events.push_back(grown);
      }
      break;
    }
    case Cause::missed_beats:
      scenario_.sensor.missed = 0.005 * severity();
      break;
    default:
      break;
    }
  }

  void read_weather() {
    const double phase = two_pi * chance_.uniform();
    double mbar = 0.0, before = 0.0;
    for (const Beat& event : events_) {
      const double t = event.time - events_.front().time;
      const double step = std::max(0.0, t - before);
      before = t;
      mbar += -mbar * step / 2e5 + 10.0 * std::sqrt(2.0 * step / 2e5) * weather_.normal();
      temperature_.push_back(2.0 * std::sin(two_pi * t / seconds_per_day + phase));
      pressure_.push_back(mbar);
    }
  }

  /// Moves the times as a rate that follows `rate_at(i, t)` would.
  template <class Rate> void follow(const Rate& rate_at) {
    double early = 0.0, before = 0.0;
    const Instant start = events_.front().time;
    for (std::size_t i = 0; i < events_.size(); ++i) {
      const double t = events_[i].time - start;
      early += (t - before) * rate_at(i, t);
      before = t;
      events_[i].time = events_[i].time + -early;
    }
  }

  void displace(double part, double late_s) {
    const double from_s = part * clock_.days * seconds_per_day;
    const Instant start = events_.front().time;
    for (Beat& event : events_)
      if (event.time - start > from_s) event.time = event.time + late_s;
  }

  void put_into_times(Cause fault) {
    const double length_s = clock_.days * seconds_per_day;
    switch (fault) {
    case Cause::temperature: {
      const double answer = -5e-6 * severity();
      follow([&](std::size_t i, double) { return answer * temperature_[i]; });
      break;
    }
    case Cause::unlogged_weather: {
      const double answer = -1e-5 * severity(), phase = two_pi * chance_.uniform();
      follow([&](std::size_t, double t) {
        return answer * std::sin(two_pi * t / seconds_per_day + phase);
      });
      break;
    }
    case Cause::pressure: {
      const double answer = -2e-7 * severity();
      follow([&](std::size_t i, double) { return answer * pressure_[i]; });
      break;
    }
    case Cause::length_drift: { // creep: fast first
      const double creep = -5e-6 * severity();
      follow([&](std::size_t, double t) {
        return creep * std::log1p(10.0 * t / length_s) / std::log(11.0);
      });
      break;
    }
    case Cause::log_clock: {
      const double drift = 5e-6 * severity();
      follow([&](std::size_t, double t) { return drift * t / length_s; });
      break;
    }
    case Cause::magnet: {
      const double pull = 5e-6 * severity();
      const double until = somewhere_ + (somewhere_ < 0.5 ? 0.3 : -0.3);
      follow([&](std::size_t, double t) {
        const double part = t / length_s;
        return (part > somewhere_) != (part > until) ? pull : 0.0;
      });
      break;
    }
    case Cause::sensor_shift:
      displace(somewhere_, 4e-4 * severity());
      break;
    case Cause::knock:
      for (int k = 0; k < 6; ++k)
        displace(between(0.05, 0.95), (chance_.uniform() < 0.5 ? -4e-4 : 4e-4) * severity());
      break;
    case Cause::stop: { // half an hour and a part of a beat later it is started again
      const double late_s = 1800.0 + scenario_.clock.nominal_period_s * between(0.2, 0.8);
      displace(somewhere_, late_s);
      break;
    }
    default:
      break;
    }
  }

  [[nodiscard]] std::string text() const {
    const bool has_weather = std::find(clock_.faults.begin(), clock_.faults.end(),
                                       Cause::unlogged_weather) == clock_.faults.end();
    std::string lines = "time (s)";
    if (has_amplitude_) lines += ",amplitude (rad)";
    if (has_weather) lines += ",temperature (C),pressure (mbar)";
    const Instant start = events_.front().time;
    auto out = std::back_inserter(lines);
    for (std::size_t i = 0; i < events_.size(); ++i) {
      fmt::format_to(out, "\n{:.8f}", events_[i].time - start);
      if (has_amplitude_) fmt::format_to(out, ",{:.7f}", events_[i].amplitude_rad);
      if (has_weather)
        fmt::format_to(out, ",{:.3f},{:.3f}", 20.0 + temperature_[i], 1000.0 + pressure_[i]);
    }
    return lines;
  }

  SickClock clock_;
  RandomStream chance_, weather_;
  Scenario scenario_;
  bool has_amplitude_ = false;
  double somewhere_ = 0.5;
  std::vector<Beat> events_;
  std::vector<double> temperature_, pressure_;
};

/// What a user is told of it.
inline std::vector<Suspicion> diagnosed(const SickClock& clock) {
  Clinic clinic(clock);
  LoadRequest request;
  request.path = "clinic.csv";
  AnalysisRequest asked;
  asked.traces_profiles = false;
  return analyse(load_text(clinic.log(), request), asked).suspicions;
}

/// What a log alone says, without a fit: a rough drive is not judged.
inline std::vector<Suspicion> suspected_in(const std::string& text) {
  LoadRequest request;
  request.path = "clinic.csv";
  const NumberedLog loaded = load_text(text, request);
  const TimingData times = fit_data(loaded);
  return diagnose(diagnosis_input(times, loaded, diary_of(loaded, times),
                                  analyse_drive(loaded.good, loaded.nominal_period_s, {}), {}));
}

inline std::vector<Suspicion> suspected(const SickClock& clock) {
  return suspected_in(Clinic(clock).log());
}

/// Whether the first suspicion is one of the faults, or lists one among what the log cannot tell
/// from it; for a fault that is not in the list `unknown` will do.
inline bool is_named(const std::vector<Suspicion>& found, const std::vector<Cause>& faults,
                     bool in_list) {
  if (found.empty()) return false;
  const auto is_fault = [&](Cause cause) {
    return std::find(faults.begin(), faults.end(), cause) != faults.end();
  };
  if (is_fault(found.front().cause)) return true;
  if (in_list) return false;
  const auto& others = found.front().alternatives;
  return found.front().cause == Cause::unknown ||
         std::any_of(others.begin(), others.end(), is_fault);
}

} // namespace goingrate::test

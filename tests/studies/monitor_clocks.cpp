#include "studies/monitor_clocks.hpp"

#include "goingrate/base/random.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace goingrate {

namespace {

constexpr double minutes_a_year = 525960.0, minutes_a_day = 1440.0;
constexpr double weather_minutes = 3.0 * minutes_a_day;

double wave_of(double minute, double period_minutes) {
  return std::sin(2.0 * std::numbers::pi * minute / period_minutes);
}

// A quantity of variance 1 with a memory.
class Remembered {
public:
  double next(double memory_minutes, RandomStream& random) {
    value_ += -value_ / memory_minutes + std::sqrt(2.0 / memory_minutes) * random.normal();
    return value_;
  }

private:
  double value_ = 0.0;
};

// The time since a clock was wound, as a share of what is usual.
class Winding {
public:
  Winding(double days, double scatter, RandomStream& random)
      : usual_minutes_(days * minutes_a_day), scatter_(scatter), random_(random),
        next_(usual_minutes_ * random.uniform()), last_(next_ - usual_minutes_) {}

  double since(double minute) {
    if (minute >= next_) {
      last_ = minute;
      constexpr double earliest = 0.6, latest = 1.2;
      next_ =
          minute + usual_minutes_ * std::clamp(1.0 + scatter_ * random_.normal(), earliest, latest);
    }
    return (minute - last_) / usual_minutes_;
  }
  [[nodiscard]] bool is_going_on(double minute) const {
    constexpr double winding_minutes = 5.0;
    return last_ >= 0.0 && minute - last_ < winding_minutes;
  }

private:
  double usual_minutes_, scatter_;
  RandomStream& random_;
  double next_, last_;
};

} // namespace

std::vector<double> minute_rates(const SwungClock& w, double years, std::uint64_t seed) {
  Scenario scenario;
  scenario.clock = w.clock;
  scenario.drive.fast_rms = w.fast_rms;
  scenario.drive.slow_rms = w.slow_rms;
  if (w.slow_rms > 0.0) scenario.drive.slow_time_s = 3600.0;
  scenario.duration_s = years * minutes_a_year * 60.0;
  scenario.method.method = Method::map;
  RandomStream jitter(seed, StreamPurpose::jitter), weather(seed, StreamPurpose::temperature_noise);
  Remembered warmth;
  ClockRun run(scenario, seed);
  std::vector<double> rates;
  double from_s = 0.0, from_cycle = 0.0;
  while (const auto period = run.next()) {
    const double at_s = period->time_s.value();
    if (at_s < 60.0 * static_cast<double>(rates.size() + 1)) continue;
    const double heard_s = at_s + w.jitter_s * jitter.normal();
    const auto cycle = static_cast<double>(period->cycle);
    const double warm = warmth.next(weather_minutes, weather);
    rates.push_back((cycle - from_cycle) * w.clock.nominal_period_s / (heard_s - from_s) - 1.0 -
                    0.5e-6 * w.daily_ppm * (wave_of(at_s / 60.0, minutes_a_day) + warm / 3.0));
    from_s = heard_s;
    from_cycle = cycle;
  }
  return rates;
}

std::vector<double> minute_rates(const WanderingClock& w, double years, std::uint64_t seed) {
  RandomStream noise(seed, StreamPurpose::jitter), weather(seed, StreamPurpose::temperature_noise),
      slow(seed, StreamPurpose::slow_drive), hand(seed, StreamPurpose::missed);
  Winding winding(w.wound_days, w.wound_scatter, hand);
  Remembered warmth;
  constexpr std::size_t octaves = 20; // to a year
  std::array<Remembered, octaves> flicker;
  std::vector<double> rates(static_cast<std::size_t>(years * minutes_a_year));
  double walked = 0.0;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    const auto minute = static_cast<double>(i);
    double rate = w.minute_noise * noise.normal() - w.saw_tooth * winding.since(minute);
    if (winding.is_going_on(minute)) rate += w.pulse;
    const double warm = warmth.next(weather_minutes, weather);
    rate += w.daily * ((1.0 + 0.3 * warm) * (wave_of(minute, minutes_a_day) +
                                             0.3 * wave_of(minute + 100.0, minutes_a_day / 2.0)) +
                       0.3 * warm);
    rate += w.yearly * wave_of(minute + static_cast<double>(seed % 12) * 43830.0, minutes_a_year);
    walked += w.walk / std::sqrt(minutes_a_day) * slow.normal();
    if (w.flicker > 0.0)
      for (std::size_t octave = 0; octave < octaves; ++octave)
        rate +=
            w.flicker * flicker[octave].next(std::exp2(static_cast<double>(octave)) + 1.0, slow);
    rates[i] = 1e-6 * (rate + walked);
  }
  return rates;
}

} // namespace goingrate

// How often a healthy clock that is watched for years is called out for a step of its rate, and how
// long a step of some ppm takes to be found. Arguments: years of each clock (4), first seed (1).
#include "step_alarm.hpp"

#include "goingrate/base/random.hpp"
#include "goingrate/dynamics/clock_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <string>
#include <vector>

using namespace goingrate;

namespace {

struct Watched {
  const char* name;
  ClockParameters clock;
  double fast_rms, slow_rms; // of the drive, relative
  double jitter_s;
  double daily_ppm; // of the length, by temperature
};

const std::vector<Watched> clocks{
    {"regulator, 2 s, Q 10,000", {2.0, 5e-5, 4e-6, 0.015}, 0.05, 0.0, 2e-5, 0.5},
    {"longcase, 2 s, Q 2000", {2.0, 2.5e-4, 4e-5, 0.03}, 0.2, 0.02, 5e-5, 10.0},
    {"turret, 3 s, Q 5000", {3.0, 1e-4, 1e-5, 0.02}, 0.1, 0.01, 2e-5, 5.0},
};

// Rates of minutes over some years, with a step of the length at `step_s`.
std::vector<double> minute_rates(const Watched& w, double years, std::uint64_t seed) {
  Scenario scenario;
  scenario.clock = w.clock;
  scenario.drive.fast_rms = w.fast_rms;
  scenario.drive.slow_rms = w.slow_rms;
  if (w.slow_rms > 0.0) scenario.drive.slow_time_s = 3600.0;
  scenario.duration_s = years * 365.25 * 86400.0;
  scenario.method.method = Method::map;
  RandomStream jitter(seed, StreamPurpose::jitter);
  ClockRun run(scenario, seed);
  std::vector<double> rates;
  double from_s = 0.0, from_cycle = 0.0;
  while (const auto period = run.next()) {
    const double at_s = period->time_s.value();
    if (at_s < 60.0 * static_cast<double>(rates.size() + 1)) continue;
    const double heard_s = at_s + w.jitter_s * jitter.normal();
    const auto cycle = static_cast<double>(period->cycle);
    const double day = 2.0 * 3.141592653589793 * at_s / 86400.0;
    rates.push_back((cycle - from_cycle) * w.clock.nominal_period_s / (heard_s - from_s) - 1.0 -
                    0.5e-6 * w.daily_ppm * std::sin(day));
    from_s = heard_s;
    from_cycle = cycle;
  }
  return rates;
}

double spread(const std::vector<double>& x) {
  double mean = 0.0, squares = 0.0;
  for (const double v : x)
    mean += v / static_cast<double>(x.size());
  for (const double v : x)
    squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(x.size()));
}

// Minutes from a step to its alarm; the length of the rest if there is none.
double delay_of(const std::vector<double>& rates, std::size_t at, double step) {
  apps::StepAlarm alarm;
  constexpr std::size_t learnt_minutes = 90 * 1440;
  const std::size_t from = at - std::min(at, learnt_minutes);
  for (std::size_t i = from; i < rates.size(); ++i) {
    const auto found = alarm.add(rates[i] + (i >= at ? step : 0.0));
    if (found && i >= at) return static_cast<double>(i - at + 1);
  }
  return static_cast<double>(rates.size() - at);
}

double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
  return x[x.size() / 2];
}

} // namespace

int main(int count, char** words) {
  const double years = count > 1 ? std::atof(words[1]) : 4.0;
  const auto seed = static_cast<std::uint64_t>(count > 2 ? std::atoll(words[2]) : 1);
  fmt::print(
      "false alarms in {:g} years of each clock; a step of the rate: median minutes to its alarm,\n"
      "and what white noise of the minutes' spread would take at one false alarm a year\n\n",
      years);
  for (const Watched& w : clocks) {
    const auto rates = minute_rates(w, years, seed);
    apps::StepAlarm alarm;
    int false_alarms = 0;
    for (const double rate : rates)
      false_alarms += alarm.add(rate) ? 1 : 0;
    const double sigma = spread(rates);
    fmt::print("{:<28} {} false alarms in {:g} years; minutes scatter by {:.2g} ppm\n", w.name,
               false_alarms, years, 1e6 * sigma);
    for (const double ppm : {2.0, 5.0, 20.0}) {
      std::vector<double> delays;
      for (std::size_t k = 1; k <= 15; ++k)
        delays.push_back(delay_of(rates, k * rates.size() / 17, 1e-6 * ppm));
      const double theory =
          std::max(1.0, 2.0 * std::log(525960.0) * std::pow(1e6 * sigma / ppm, 2));
      fmt::print("{:>28} {:3.0f} ppm: {:7.0f} min, {:7.0f} by theory\n", "", ppm, median(delays),
                 theory);
    }
  }
}

// How often a healthy clock that is watched for years is called out for a step of its rate, and how
// long a step of some ppm takes to be found. Arguments: years of each clock (4), first seed (1).
#include "daily_wave.hpp"
#include "step_alarm.hpp"

#include "goingrate/base/random.hpp"
#include "goingrate/dynamics/clock_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <limits>
#include <string>
#include <vector>

using namespace goingrate;
using namespace goingrate::apps;

namespace {

struct Watched {
  const char* name;
  ClockParameters clock;
  double fast_rms, slow_rms; // of the drive, relative
  double jitter_s;
  double daily_ppm; // of the length, by temperature; weather of some days has a third of it
};

const std::vector<Watched> clocks{
    {"regulator, 2 s, Q 10,000", {2.0, 5e-5, 4e-6, 0.015}, 0.05, 0.0, 2e-5, 0.5},
    {"longcase, 2 s, Q 2000", {2.0, 2.5e-4, 4e-5, 0.03}, 0.2, 0.02, 5e-5, 10.0},
    {"turret, 3 s, Q 5000", {3.0, 1e-4, 1e-5, 0.02}, 0.1, 0.01, 2e-5, 5.0},
};

// Rates of minutes over some years.
std::vector<double> minute_rates(const Watched& w, double years, std::uint64_t seed) {
  Scenario scenario;
  scenario.clock = w.clock;
  scenario.drive.fast_rms = w.fast_rms;
  scenario.drive.slow_rms = w.slow_rms;
  if (w.slow_rms > 0.0) scenario.drive.slow_time_s = 3600.0;
  scenario.duration_s = years * 365.25 * 86400.0;
  scenario.method.method = Method::map;
  RandomStream jitter(seed, StreamPurpose::jitter), weather(seed, StreamPurpose::temperature_noise);
  constexpr double weather_minutes = 3.0 * 1440.0;
  double warmth = 0.0;
  ClockRun run(scenario, seed);
  std::vector<double> rates;
  double from_s = 0.0, from_cycle = 0.0;
  while (const auto period = run.next()) {
    const double at_s = period->time_s.value();
    if (at_s < 60.0 * static_cast<double>(rates.size() + 1)) continue;
    const double heard_s = at_s + w.jitter_s * jitter.normal();
    const auto cycle = static_cast<double>(period->cycle);
    warmth += -warmth / weather_minutes + std::sqrt(2.0 / weather_minutes) * weather.normal();
    const double day = 2.0 * 3.141592653589793 * at_s / 86400.0;
    rates.push_back((cycle - from_cycle) * w.clock.nominal_period_s / (heard_s - from_s) - 1.0 -
                    0.5e-6 * w.daily_ppm * (std::sin(day) + warmth / 3.0));
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

// As a monitor hears it: without the wave of the day.
std::optional<FoundStep> heard(DailyWave& wave, StepAlarm& alarm, std::size_t minute, double rate) {
  const auto found = alarm.add(wave.without(static_cast<std::int64_t>(minute), rate));
  if (found) wave.stepped(found->size);
  return found;
}

// Minutes from a step to its alarm; infinity if none comes within sixty days.
double delay_of(const std::vector<double>& rates, std::size_t at, double step) {
  DailyWave wave;
  StepAlarm alarm;
  constexpr std::size_t learnt_minutes = 90 * 1440;
  const std::size_t from = at - std::min(at, learnt_minutes);
  for (std::size_t i = from; i < std::min(rates.size(), at + 60 * 1440); ++i) {
    const auto found = heard(wave, alarm, i, rates[i] + (i >= at ? step : 0.0));
    if (found && i >= at) return static_cast<double>(i - at + 1);
  }
  return std::numeric_limits<double>::infinity();
}

// What of a step of 1 a whitened series shows after each minute, squared and in units of its noise:
// the prediction of order `most` from the minutes before, by Levinson's recursion.
std::vector<double> information_of_step(const std::vector<double>& x, std::size_t most) {
  std::vector<double> lags(most + 1);
  for (std::size_t lag = 0; lag <= most; ++lag)
    for (std::size_t i = lag; i < x.size(); ++i)
      lags[lag] += x[i] * x[i - lag] / static_cast<double>(x.size());
  std::vector<double> filter;
  double noise = lags[0];
  for (std::size_t order = 1; order <= most; ++order) {
    double reflection = lags[order];
    for (std::size_t j = 0; j < filter.size(); ++j)
      reflection -= filter[j] * lags[order - 1 - j];
    reflection /= noise;
    std::vector<double> next = filter;
    for (std::size_t j = 0; j < filter.size(); ++j)
      next[j] -= reflection * filter[filter.size() - 1 - j];
    next.push_back(reflection);
    filter = std::move(next);
    noise *= 1.0 - reflection * reflection;
  }
  std::vector<double> information;
  double seen = 1.0, sum = 0.0;
  for (std::size_t k = 0; k <= most; ++k) {
    information.push_back(sum += seen * seen / noise);
    if (k < most) seen -= filter[k];
  }
  return information;
}

// Minutes after which no detector that is called out falsely once a year finds a step sooner on
// average (Lorden's bound): where half the information is the logarithm of the minutes of a year.
double least_delay(const std::vector<double>& information, double step) {
  const double needed = 2.0 * std::log(525960.0) / (step * step);
  const auto reached = std::lower_bound(information.begin(), information.end(), needed);
  if (reached == information.end()) return std::numeric_limits<double>::infinity();
  return static_cast<double>(reached - information.begin() + 1);
}

std::string minutes(double count) {
  return std::isinf(count) ? "not found" : fmt::format("{:.0f} min", count);
}

// Rates less the wave that is the same every day, and less their mean.
std::vector<double> without_mean_day(std::vector<double> rates) {
  constexpr std::size_t day = 1440;
  for (std::size_t minute = 0; minute < day; ++minute) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = minute; i < rates.size(); i += day, ++count)
      sum += rates[i];
    for (std::size_t i = minute; i < rates.size(); i += day)
      rates[i] -= sum / count;
  }
  return rates;
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
      "and the least that any detector needs that is called out falsely once a year (Lorden;\n"
      "what it does not find within 5000 minutes it never does: the clock's wander hides it)\n\n",
      years);
  for (const Watched& w : clocks) {
    const auto rates = minute_rates(w, years, seed);
    DailyWave wave;
    StepAlarm alarm;
    int false_alarms = 0;
    for (std::size_t i = 0; i < rates.size(); ++i)
      false_alarms += heard(wave, alarm, i, rates[i]) ? 1 : 0;
    constexpr std::size_t prediction_minutes = 5000;
    const auto information = information_of_step(without_mean_day(rates), prediction_minutes);
    fmt::print("{:<28} {} false alarms in {:g} years; minutes scatter by {:.2g} ppm\n", w.name,
               false_alarms, years, 1e6 * spread(rates));
    for (const double ppm : {2.0, 5.0, 20.0}) {
      std::vector<double> delays;
      for (std::size_t k = 1; k <= 15; ++k)
        delays.push_back(delay_of(rates, k * rates.size() / 17, 1e-6 * ppm));
      fmt::print("{:>28} {:3.0f} ppm: {:>9}, by theory {}\n", "", ppm, minutes(median(delays)),
                 minutes(least_delay(information, 1e-6 * ppm)));
    }
  }
}

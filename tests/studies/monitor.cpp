// How often a monitor reports a step of the rate of a healthy clock that is watched for years, and
// how long a step of some ppm takes to be found. Arguments: years of each clock (4), first seed
// (1).
#include "daily_wave.hpp"
#include "step_alarm.hpp"
#include "studies/monitor_clocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <limits>
#include <string>
#include <vector>

using namespace goingrate;
using namespace goingrate::apps;

namespace {

double spread(const std::vector<double>& x) {
  double mean = 0.0, squares = 0.0;
  for (const double v : x)
    mean += v / static_cast<double>(x.size());
  for (const double v : x)
    squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(x.size()));
}

// What a monitor has learnt of the rate.
struct Watch {
  DailyWave wave;
  StepAlarm alarm{10e-6}; // as Alarms has it

  std::optional<FoundStep> hear(std::size_t minute, double rate) {
    const auto found = alarm.add(wave.without(static_cast<std::int64_t>(minute), rate));
    if (found) wave.stepped(found->size);
    return found;
  }
};

// Minutes from a step to its alarm; infinity if none comes within sixty days.
double delay_of(Watch watch, const std::vector<double>& rates, std::size_t at, double step) {
  for (std::size_t i = at; i < std::min(rates.size(), at + 60 * 1440); ++i)
    if (watch.hear(i, rates[i] + step)) return static_cast<double>(i - at + 1);
  return std::numeric_limits<double>::infinity();
}

// How much of a step of 1 a whitened series shows after each minute, squared and in units of its
// noise: the prediction of order `most` from the minutes before, by Levinson's recursion.
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
  return std::isinf(count) ? "never" : fmt::format("{:.0f}", count);
}

// Rates of a year less the wave that is the same every day, and less their mean.
std::vector<double> without_mean_day(std::vector<double> rates) {
  constexpr std::size_t day = 1440, year = 525960;
  rates.resize(std::min(rates.size(), year));
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

constexpr std::array steps_ppm{2.0, 5.0, 20.0};

void print_clock(const std::string& name, const std::vector<double>& rates, double years) {
  constexpr std::size_t steps_of_each = 15;
  Watch watch;
  int false_alarms = 0;
  std::array<std::vector<double>, steps_ppm.size()> delays;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    if (i > 0 && i % (rates.size() / (steps_of_each + 2)) == 0 && delays[0].size() < steps_of_each)
      for (std::size_t s = 0; s < steps_ppm.size(); ++s)
        delays[s].push_back(delay_of(watch, rates, i, 1e-6 * steps_ppm[s]));
    if (watch.hear(i, rates[i])) ++false_alarms;
  }
  constexpr std::size_t prediction_minutes = 5000;
  const auto information = information_of_step(without_mean_day(rates), prediction_minutes);
  fmt::print("{:<46} {:5.2f} {:3} {:5.2f}", name, 1e6 * spread(rates), false_alarms,
             static_cast<double>(false_alarms) / years);
  for (std::size_t s = 0; s < steps_ppm.size(); ++s)
    fmt::print(" {:>5}/{:<5}", minutes(median(delays[s])),
               minutes(least_delay(information, 1e-6 * steps_ppm[s])));
  fmt::print("\n");
  std::fflush(stdout);
}

} // namespace

int main(int count, char** words) {
  const double years = count > 1 ? std::atof(words[1]) : 4.0;
  const auto seed = static_cast<std::uint64_t>(count > 2 ? std::atoll(words[2]) : 1);
  fmt::print("steps of the rate: how much minutes scatter, ppm; false alarms in {:g} years, and a "
             "year;\nmedian minutes from a step of 2, 5 and 20 ppm to its alarm / the least that "
             "any detector\nneeds that is called out falsely once a year (Lorden, of a Gaussian "
             "clock of that spectrum;\nwhat it does not find within 5000 minutes it never "
             "does)\n\n{:<46} {:>5} {:>3} {:>5} {:>11} {:>11} {:>11}\n",
             years, "", "ppm", "n", "/year", "2 ppm", "5 ppm", "20 ppm");
  for (const SwungClock& clock : swung_clocks)
    print_clock(clock.name, minute_rates(clock, years, seed), years);
  for (const WanderingClock& clock : wandering_clocks)
    print_clock(clock.name, minute_rates(clock, years, seed), years);
}

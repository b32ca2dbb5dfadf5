// The data of a fit, from a log: times, amplitudes, and the covariates that may drive the rate.
#include "goingrate/analysis/analyse.hpp"

#include "rounding.hpp"

#include "causes/reading_changes.hpp"
#include "causes/reading_errors.hpp"
#include "fit/fit_setup.hpp"
#include "goingrate/causes/covariates.hpp"
#include "goingrate/log/tides.hpp"
#include "goingrate/log/weather.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace goingrate {

namespace {

// The values of a column, which has one for each event, at the good beats.
std::vector<double> at_good_beats(const std::vector<double>& column, const NumberedLog& loaded) {
  std::vector<double> values;
  values.reserve(loaded.good.size());
  const std::vector<Beat>& events = loaded.beats.beats;
  for (std::size_t i = 0; i < events.size(); ++i)
    if (events[i].flag == BeatFlag::good && events[i].segment == loaded.good.front().segment)
      values.push_back(column[i]);
  return values;
}

// The standard deviations of amplitudes found from a flag's dark times, in units of the jitter of a
// dark time, which is the same at every beat. Each is the median over the neighbours of the beat,
// so that a beat's own noise does not set its weight.
std::vector<double> width_noise(const TimingData& data, const std::vector<double>& width_s) {
  constexpr std::size_t beats_each_side = 10;
  std::vector<double> sigmas;
  for (std::size_t i = 0; i < data.size(); ++i) {
    std::vector<double> near;
    const std::size_t first = i > beats_each_side ? i - beats_each_side : 0;
    for (std::size_t k = first; k < std::min(data.size(), i + beats_each_side + 1); ++k) {
      const double sigma = amplitude_sigma_from_width(width_s[k], 1.0, data.amplitude_rad[k],
                                                      data.reference_period_s);
      if (std::isfinite(sigma)) near.push_back(sigma);
    }
    if (near.empty()) {
      sigmas.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
    std::nth_element(near.begin(), middle, near.end());
    sigmas.push_back(*middle);
  }
  return sigmas;
}

const RateTerm* find(const std::vector<RateTerm>& terms, std::string_view name) {
  const auto term = std::find_if(terms.begin(), terms.end(),
                                 [&](const RateTerm& known) { return known.name == name; });
  return term == terms.end() ? nullptr : &*term;
}

double mean_of_known(const std::vector<double>& values, double fallback) {
  double sum = 0.0, count = 0.0;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    sum += v;
    ++count;
  }
  return count > 0.0 ? sum / count : fallback;
}

// The standard deviation of an interpolated air density, from those of temperature, pressure and
// humidity: first order about the mean weather.
double density_sigma(const EventColumns& columns, const std::vector<RateTerm>& terms) {
  // Used where no value is known. The derivatives of the density hardly depend on them.
  constexpr double usual_temperature_c = 20.0, usual_pressure_mbar = 1013.25;
  constexpr double usual_humidity_percent = 50.0;
  const auto sigma_of = [&](std::string_view name) {
    const RateTerm* term = find(terms, name);
    return term != nullptr && term->step_s > 0.0 ? term->sigma : 0.0;
  };
  const double t = mean_of_known(columns.temperature_c, usual_temperature_c);
  const double p = mean_of_known(columns.pressure_mbar, usual_pressure_mbar);
  const double h = mean_of_known(columns.humidity_percent, usual_humidity_percent);
  const double dt = sigma_of("temperature"), dp = sigma_of("pressure"), dh = sigma_of("humidity");
  const std::vector<double> rho = air_density(
      std::vector{t, t + dt, t, t}, std::vector{p, p, p + dp, p}, std::vector{h, h, h, h + dh});
  return std::hypot(rho[1] - rho[0], rho[2] - rho[0], rho[3] - rho[0]);
}

// Gives the terms of weather that was read from files of its own the error of an interpolated value
// and the time between two readings.
void put_interpolation(const ClockLog& log, std::vector<RateTerm>& terms) {
  double longest_step_s = 0.0;
  for (const JoinedWeather& weather : log.weather) {
    for (RateTerm& term : terms) {
      if (term.name != weather.quantity) continue;
      term.sigma = std::isnan(weather.sigma) ? 0.0 : weather.sigma;
      term.step_s = weather.step_s;
    }
    longest_step_s = std::max(longest_step_s, weather.step_s);
  }
  for (RateTerm& term : terms)
    if (term.name == "density" && longest_step_s > 0.0) {
      term.sigma = density_sigma(log.columns, terms);
      term.step_s = longest_step_s;
    }
}

// Adds a term for each quantity of the weather that the log has a column of.
void add_weather(const NumberedLog& loaded, TimingData& data) {
  const auto add = [&](const char* name, const char* unit, const std::vector<double>& column) {
    if (column.empty()) return;
    const std::vector<double> values = at_good_beats(column, loaded);
    const std::vector<JoinedWeather>& joined = loaded.log.weather;
    const bool between_readings =
        std::any_of(joined.begin(), joined.end(), [&](const JoinedWeather& weather) {
          return weather.quantity == name || std::string_view(name) == "density";
        });
    if (between_readings)
      data.terms.push_back(rate_term(name, unit, data, values));
    else
      timing_model::add_readings(name, unit, values, data);
  };
  const EventColumns& columns = loaded.log.columns;
  add("temperature", "1/K", columns.temperature_c);
  add("pressure", "1/mbar", columns.pressure_mbar);
  add("humidity", "1/%", columns.humidity_percent);
  if (!columns.temperature_c.empty() && !columns.pressure_mbar.empty())
    add("density", "m^3/kg",
        air_density(columns.temperature_c, columns.pressure_mbar, columns.humidity_percent));
  put_interpolation(loaded.log, data.terms);
}

// The term of the tide; nothing if the clock's location or the dates are not known.
std::optional<RateTerm> tide_term(const NumberedLog& loaded, const TimingData& data) {
  const ClockLog& log = loaded.log;
  if (!log.site || log.origin == TimeOrigin::none || loaded.good.empty()) return {};
  Instant begin = loaded.good.front().time;
  begin.seconds -= seconds_before_1970(log.origin);
  return RateTerm{"tide", "", tidal_advance(data.elapsed_s, begin, *log.site)};
}

// How many times the waves of the wheels come round from push to push: the greatest common divisor
// over those that do so a whole number of times, 0 without any.
int turns_between_pushes(const ImpulseCycle& pushes, const TimingData& data) {
  constexpr double tolerance = 0.05; // turns
  int common = 0;
  for (const Wheel& wheel : data.wheels) {
    const double turns = pushes.periods * data.reference_period_s / wheel.turn_s;
    const double whole = std::round(turns);
    if (whole >= 1.0 && std::abs(turns - whole) < tolerance)
      common = std::gcd(common, static_cast<int>(whole));
  }
  return common;
}

// Whether a wheel passes for pushes: a wave gains more than they do, and it is no overtone of a
// saw-tooth. A saw-tooth has waves of every number of turns from push to push, of which the second
// may stand out alone; a wheel that turns k times has waves of multiples of k.
bool is_a_wheels(const ImpulseCycle& pushes, const TimingData& data) {
  if (!pushes.is_regular) return false;
  const int turns = turns_between_pushes(pushes, data);
  return (turns == 0 || turns > 2) &&
         std::any_of(data.wheels.begin(), data.wheels.end(),
                     [&](const Wheel& wheel) { return wheel.gain > pushes.gain; });
}

// The mean of the first or the last known amplitudes, rad.
double amplitude_at_end(const TimingData& data, bool last) {
  constexpr std::size_t averaged = 20; // amplitudes
  std::vector<double> known;
  for (const double amplitude : data.amplitude_rad)
    if (!std::isnan(amplitude)) known.push_back(amplitude);
  const std::size_t count = std::min(averaged, known.size());
  const auto from = last ? known.end() - static_cast<std::ptrdiff_t>(count) : known.begin();
  return std::accumulate(from, from + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

// Pushes once in N swings. A swing that loses more than all of them give is not kept up by them:
// what recurs in a ring-down has another cause.
std::optional<ImpulseCycle> pushes_of(const TimingData& data) {
  std::optional<ImpulseCycle> found = find_impulse_cycle(data);
  if (!found || !found->amplitude_step) return found;
  const double given = found->amplitude_step->value * data.cycle.back() / found->periods;
  const double lost = amplitude_at_end(data, false) - amplitude_at_end(data, true);
  return lost > given ? std::nullopt : found;
}

// Pushes once in N swings, or else wheels of the train, which are subtracted. What a wheel does may
// pass for pushes once in many of its turns.
void find_what_recurs(TimingData& data) {
  if (!data.has_amplitude() && rounding_explains(data)) return;
  data.impulses = pushes_of(data);
  TimingData without = data;
  level_wheels(without);
  if (data.impulses && !is_a_wheels(*data.impulses, without)) return;
  data.impulses = find_waiting_pushes(data, without.wheels);
  if (data.impulses) return;
  data = std::move(without);
  if (!data.wheels.empty()) data.impulses = pushes_of(data);
}

// The readings for which the beats stand in, from the first beat to the last.
void put_readings(const NumberedLog& loaded, TimingData& data) {
  const double step_s = data.reference_period_s;
  for (const Reading& reading : loaded.log.readings) {
    const double elapsed_s = reading.time - loaded.good.front().time;
    if (elapsed_s < -step_s || elapsed_s > data.elapsed_s.back() + step_s) continue;
    data.as_read.elapsed_s.push_back(elapsed_s);
    data.as_read.late_s.push_back(-reading.error_s);
  }
}

} // namespace

TimingData fit_data(const NumberedLog& loaded) {
  TimingData data = timing_data(loaded.good);
  data.time_base_sigma = loaded.log.time_base_sigma;
  if (loaded.log.grid && !loaded.log.nominal_period_s)
    data.no_swings =
        "the log holds the clock's error at equal intervals but not the period of its pendulum; "
        "give the nominal period";
  put_readings(loaded, data);
  const EventColumns& columns = loaded.log.columns;
  if (!columns.sigma_s.empty())
    data.time_noise = relative_noise(at_good_beats(columns.sigma_s, loaded));
  if (!columns.width_s.empty() && data.has_amplitude())
    data.amplitude_noise =
        relative_noise(width_noise(data, at_good_beats(columns.width_s, loaded)));
  add_weather(loaded, data);
  if (const auto tide = tide_term(loaded, data)) data.terms.push_back(*tide);
  const bool swings = data.no_swings.empty() && data.reference_period_s <= longest_swing_s;
  if (swings) find_what_recurs(data);
  if (data.impulses) level_impulses(*data.impulses, data);
  if (are_few_readings(data))
    timing_model::level_settings(data);
  else
    level_displacements(data);
  return data;
}

FitOptions with_seen_weather(FitOptions options, const NumberedLog& loaded) {
  const EventColumns& columns = loaded.log.columns;
  const bool has_weather = !columns.temperature_c.empty() || !columns.pressure_mbar.empty() ||
                           !columns.humidity_percent.empty();
  if (!has_weather || timing_model::names(options, "density")) return options;
  TimingData data = timing_data(loaded.good);
  add_weather(loaded, data);
  for (const WeatherPart& part : weather_parts(data))
    if (!timing_model::names(options, part.name)) options.freed.push_back(part.name);
  return options;
}

} // namespace goingrate

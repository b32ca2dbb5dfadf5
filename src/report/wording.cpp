#include "wording.hpp"

#include "base/printable.hpp"
#include "base/scaled_time.hpp"
#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr DisplayUnit per_day{"s/day", seconds_per_day};
constexpr DisplayUnit thousandths_per_day{"ms/day", 1e3 * seconds_per_day};
constexpr DisplayUnit millionths_per_day{"µs/day", 1e6 * seconds_per_day};

// A rate that is smaller than its sigma is of that size.
double size_of(const RateSummary& rate) {
  const double sigma = rate.rate_excess_sigma;
  return std::max(std::abs(rate.rate_excess), std::isfinite(sigma) ? sigma : 0.0);
}

double largest_rate(const Analysis& data) {
  double largest = size_of(data.rate);
  for (const PartRate& stretch : data.stretches)
    largest = std::max(largest, size_of(stretch.rate));
  return largest;
}

double largest_deviation(const Analysis& data) {
  double largest = 0.0;
  for (const DeviationRow& row : data.deviation.rows)
    largest = std::fmax(largest, row.value); // fmax skips NaN, a deviation that is not known
  return largest;
}

DisplayUnit unit_of_rate(double largest) {
  const double largest_s = std::abs(seconds_gained_per_day(largest));
  return largest_s < 1e-3 ? millionths_per_day : largest_s < 1.0 ? thousandths_per_day : per_day;
}

DisplayUnit unit_of_angles(double largest_rad) {
  constexpr double widest_in_mrad = 0.5; // rad
  return largest_rad > widest_in_mrad ? DisplayUnit{"rad", 1.0} : DisplayUnit{"mrad", 1e3};
}

double largest_of_model(const FitSummary& fit) {
  double largest = 0.0;
  for (const double amplitude_rad : fit.model_amplitude_rad)
    largest = std::fmax(largest, amplitude_rad);
  return largest;
}

DisplayUnit unit_of_angles(const Analysis& data) {
  if (data.fit.decay) return angle_unit(*data.fit.decay);
  double largest = largest_of_model(data.fit);
  for (const Beat& beat : data.beats)
    largest = std::fmax(largest, beat.amplitude_rad); // fmax skips NaN, an unknown amplitude
  return unit_of_angles(largest);
}

// Whole seconds from 1990 to 2100: no counter that began at zero has run that long.
bool may_be_date(const Instant& time) {
  using namespace std::chrono;
  const sys_seconds at{seconds{time.seconds}};
  return at >= sys_days{1990y / January / 1} && at < sys_days{2100y / January / 1};
}

struct DateAndTime {
  std::string date, time;
};

DateAndTime date_and_time(const Instant& at) {
  using namespace std::chrono;
  const sys_seconds time{seconds{at.seconds + (at.fraction < 0.5 ? 0 : 1)}};
  const auto day = floor<days>(time);
  const year_month_day date{day};
  const hh_mm_ss clock{time - day};
  return {fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()),
                      static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day())),
          fmt::format("{:02}:{:02}:{:02}", clock.hours().count(), clock.minutes().count(),
                      clock.seconds().count())};
}

} // namespace

DisplayUnit time_unit(double duration_s) {
  if (duration_s < 2.0 * 3600.0) return {"s", 1.0};
  if (duration_s < 5.0 * seconds_per_day) return {"h", 1.0 / 3600.0};
  return {"days", 1.0 / seconds_per_day};
}

DisplayUnit angle_unit(const Decay& decay) {
  double largest = decay.amplitude_rad;
  for (const QAtAmplitude& at : decay.q_at_amplitude)
    largest = std::fmax(largest, at.amplitude_rad);
  return unit_of_angles(largest);
}

DisplayUnit angle_unit(const FitSummary& fit) {
  return fit.decay ? angle_unit(*fit.decay) : unit_of_angles(largest_of_model(fit));
}

FittedParameter in_shown_unit(const DisplayUnit& angle, FittedParameter parameter) {
  const bool is_scatter = parameter.name == "jitter_rms" || parameter.name == "walk_rms";
  const bool is_share = parameter.name == "drive_rms" || parameter.name == "slow_rms";
  const bool is_scatter_of_angles = parameter.name == "amplitude_rms";
  if (parameter.unit != "rad" && !is_scatter && !is_share) return parameter;
  const DisplayUnit unit = is_scatter             ? short_time_unit(parameter.value)
                           : is_scatter_of_angles ? small_angle_unit(parameter.value)
                           : is_share             ? DisplayUnit{"%", 100.0}
                                                  : angle;
  parameter.unit = unit.name;
  for (double* size : {&parameter.value, &parameter.sigma, &parameter.low68, &parameter.high68,
                       &parameter.low95, &parameter.high95, &parameter.sigma_by_law})
    *size *= unit.factor;
  return parameter;
}

DerivedQuantity as_shown(const DisplayUnit& angle, const FitSummary& fit,
                         DerivedQuantity quantity) {
  if (quantity.name == "mean period") {
    quantity.name = "fitted mean period"; // a report's mean period is taken from end to end
    quantity.expression += fit.model.walk || fit.model.drive || fit.model.slow
                               ? "; ± is that of the timing and of the noise of the model"
                               : "; ± is that of the timing alone, however the rate varied";
  }
  // Only the Q and the decay time of a free swing hold at one amplitude.
  if (fit.decay && (quantity.name == fit.q_factor.name || quantity.name == fit.decay_time.name))
    quantity.expression =
        fmt::format("at {} {}, whichever law of friction",
                    with_sigma(angle.factor * fit.decay->amplitude_rad, 0.0, 4), angle.name);
  if (quantity.unit != "rad") return quantity;
  quantity.unit = angle.name;
  quantity.value *= angle.factor;
  quantity.sigma *= angle.factor;
  return quantity;
}

namespace {

// The unit of the log's length, or a smaller one in which its earliest change is not a small part
// of one.
DisplayUnit unit_of_moments(const Analysis& data) {
  constexpr double least = 0.1; // of the unit
  double earliest_s = data.rate.duration_s;
  for (const Change& change : data.diary.changes)
    earliest_s = std::min(earliest_s, change.at_s);
  const DisplayUnit unit = time_unit(data.rate.duration_s);
  return unit.factor * earliest_s < least ? time_unit(earliest_s) : unit;
}

} // namespace

Wording::Wording(const Analysis& data)
    : rate_(unit_of_rate(largest_rate(data))),
      deviation_(unit_of_rate(std::max(largest_rate(data), largest_deviation(data)))),
      angle_(unit_of_angles(data)), duration_(time_unit(data.rate.duration_s)),
      moment_(unit_of_moments(data)) {
  is_read_ = data.rate.nominal_period_s > longest_swing_s;
  if (data.beats.empty()) return;
  first_ = data.beats.front().time;
  is_dated_ = may_be_date(first_);
  readings_s_ = is_read_ ? data.rate.nominal_period_s : 0.0;
  constexpr double least_spacing_s = 20.0 * 3600.0; // of readings that are told by their day
  if (data.rate.nominal_period_s > least_spacing_s) spacing_s_ = data.rate.nominal_period_s;
}

std::string Wording::rate(double rate_excess, double sigma) const {
  return fmt::format("{}{} {}", rate_excess > 0.0 ? "+" : "",
                     with_sigma(rate_.factor * rate_excess, rate_.factor * sigma), rate_.name);
}

std::string Wording::going(double rate_excess, double sigma) const {
  return fmt::format("{} {} {}", rate_excess < 0.0 ? "loses" : "gains",
                     with_sigma(rate_.factor * std::abs(rate_excess), rate_.factor * sigma),
                     rate_.name);
}

std::string Wording::size_of_rate(double size, double sigma) const {
  const bool is_known = sigma < std::abs(size);
  return fmt::format(
      "{} {}", with_sigma(rate_.factor * std::abs(size), is_known ? rate_.factor * sigma : 0.0, 3),
      rate_.name);
}

std::string Wording::angle(double rad, double sigma) const {
  return fmt::format("{} {}", with_sigma(angle_.factor * rad, angle_.factor * sigma, 4),
                     angle_.name);
}

std::string Wording::duration(double seconds) const {
  return fmt::format("{} {}", with_sigma(duration_.factor * seconds, 0.0, 3), duration_.name);
}

std::string Wording::time_since(double at_s) const {
  return fmt::format("{} {}", with_sigma(moment_.factor * at_s, 0.0, 4), moment_.name);
}

std::string Wording::day(double at_s) const {
  constexpr double clock_error_s = 300.0; // by which a reading at midnight may come before it
  return date_and_time(first_ + (spacing_s_ * std::round(at_s / spacing_s_) + clock_error_s)).date;
}

// A clock that is read every few hours shows a change to the hour at best, one that strikes or is
// read more often to the minute.
std::pair<std::string, std::string> Wording::dated(double at_s) const {
  constexpr double minute_s = 60.0, hour_s = 3600.0;
  double to_grain_s = 0.0;
  if (is_read_) {
    const double grain_s = readings_s_ > hour_s ? hour_s : minute_s;
    const double now_s = static_cast<double>(first_.seconds) + at_s;
    to_grain_s = grain_s * std::round(now_s / grain_s) - now_s;
  }
  const auto [date, time] = date_and_time(first_ + (at_s + to_grain_s));
  return {date, is_read_ ? time.substr(0, std::string_view("00:00").size()) : time};
}

std::string Wording::moment(double at_s) const {
  if (!is_dated_) return time_since(at_s) + " after the first beat";
  if (spacing_s_ > 0.0) return "on " + day(at_s);
  const auto [date, time] = dated(at_s);
  return "on " + date + (is_read_ ? " at about " : " at ") + time;
}

std::string Wording::moments(double first_s, double second_s) const {
  if (is_dated_) return moment(first_s) + " and " + moment(second_s);
  return time_since(first_s) + " and " + moment(second_s);
}

std::string Wording::span(double from_s, double to_s) const {
  if (!is_dated_)
    return fmt::format("{} to {} after the first beat", short_moment(from_s), short_moment(to_s));
  if (spacing_s_ > 0.0) return fmt::format("{} to {}", day(from_s), day(to_s));
  const auto [first_date, begin] = date_and_time(first_ + from_s);
  const auto [last_date, end] = date_and_time(first_ + to_s);
  return fmt::format("{} {} to {}", first_date, begin,
                     first_date == last_date ? end : last_date + " " + end);
}

std::string Wording::short_moment(double at_s) const {
  if (!is_dated_) return time_since(at_s);
  if (spacing_s_ > 0.0) return day(at_s);
  const auto [date, time] = dated(at_s);
  return date + " " + time;
}

std::string capitalised(std::string text) {
  if (!text.empty())
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

std::string listed(const std::vector<std::string>& names, std::string_view last_word) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? fmt::format(" {} ", last_word) : ", ";
    text += names[i];
  }
  return text;
}

std::size_t sentences_in(std::string_view text) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool ends = text[i] == '.' || text[i] == '?';
    if (ends && (i + 1 == text.size() || text[i + 1] == ' ')) ++count;
  }
  return count;
}

DisplayUnit short_time_unit(double seconds) {
  const double size = std::abs(seconds);
  if (size < 1e-6) return {"ns", 1e9};
  if (size < 1e-3) return {"µs", 1e6};
  return size < 1.0 ? DisplayUnit{"ms", 1e3} : DisplayUnit{"s", 1.0};
}

DisplayUnit small_angle_unit(double rad) {
  const double size = std::abs(rad);
  if (size < 1e-3) return {"µrad", 1e6};
  return size < 1.0 ? DisplayUnit{"mrad", 1e3} : DisplayUnit{"rad", 1.0};
}

std::string small_angle(double rad) {
  const DisplayUnit unit = small_angle_unit(rad);
  return fmt::format("{} {}", with_sigma(unit.factor * rad, 0.0, 3), unit.name);
}

std::string short_time(double seconds, double sigma_s) {
  // A time that is smaller than its sigma is written in a unit chosen by the sigma.
  const DisplayUnit unit = short_time_unit(sigma_s > std::abs(seconds) ? sigma_s : seconds);
  return fmt::format("{} {}", with_sigma(unit.factor * seconds, unit.factor * sigma_s, 3),
                     unit.name);
}

bool swings_freely(const Analysis& data) {
  return data.fit.has_result() && data.fit.model.escapement == Escapement::none;
}

std::string unit_of_covariate(const CovariateEffect& effect) {
  return effect.unit == "m^3/kg" ? "kg/m³" : effect.unit.substr(effect.unit.find('/') + 1);
}

std::string file_name(const std::string& path) {
  if (path == "-") return "standard input";
  const std::filesystem::path named(path);
  return printable((named.has_filename() ? named : named.parent_path()).filename().string());
}

} // namespace goingrate

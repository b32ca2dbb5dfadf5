#include "goingrate/log/weather.hpp"

#include "base/special_values.hpp"
#include "calendar.hpp"
#include "typical_period.hpp"
#include "weather_quantities.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace goingrate {

namespace {

constexpr double longest_hole = 3.0; // usual steps over which is interpolated

struct Reading {
  Instant time;
  double value = 0.0;
  double usual_step_s = 0.0; ///< of its file
};

double usual_step(const std::vector<Reading>& readings) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < readings.size(); ++i)
    steps.push_back(readings[i].time - readings[i - 1].time);
  return steps.empty() ? 0.0 : median(steps);
}

bool is_hole(const Reading& a, const Reading& b) {
  return b.time - a.time > longest_hole * std::max(a.usual_step_s, b.usual_step_s);
}

/// The readings of one quantity, in order of time, and the curve between them: straight lines, or a
/// cubic spline where neighbours predict a reading better by cubics than by lines.
class ReadingsCurve {
public:
  explicit ReadingsCurve(std::vector<Reading> readings)
      : readings_(std::move(readings)), bend_(readings_.size(), 0.0) {
    step_s_ = usual_step(readings_);
    const double straight = left_out_rms(1), cubic = left_out_rms(2);
    sigma_ = 2.0 / 3.0 * std::fmin(straight, cubic); // NaN if neither can be had
    if (!(cubic < straight)) return;
    std::size_t first = 0;
    for (std::size_t i = 1; i <= size(); ++i)
      if (i == size() || is_hole(readings_[i - 1], readings_[i])) {
        bend(first, i);
        first = i;
      }
  }

  [[nodiscard]] std::size_t size() const { return readings_.size(); }
  [[nodiscard]] double step_s() const { return step_s_; }

  /// NaN in a hole and outside the readings. Fast where `time` rises from call to call.
  double at(const Instant& time) {
    if (time < readings_.front().time || readings_.back().time < time) return not_known;
    find(time);
    const Reading &a = readings_[last_], &b = readings_[last_ + 1];
    const double h = b.time - a.time;
    if (is_hole(a, b)) return not_known;
    const double right = (time - a.time) / h, left = 1.0 - right;
    return left * a.value + right * b.value +
           h * h / 6.0 *
               ((left * left * left - left) * bend_[last_] +
                (right * right * right - right) * bend_[last_ + 1]);
  }

  /// The standard deviation of an interpolated value. Where the errors of readings are independent, with variance v, the
  /// departure of a reading from the line between its neighbours has the variance 3/2 v, and an
  /// interpolated value, over all places between two readings, 2/3 v, which is 4/9 of that. For a
  /// random walk it is 1/3 of it, for smoother courses less, and with cubics too.
  [[nodiscard]] double sigma() const { return sigma_; }

private:
  [[nodiscard]] double step(std::size_t i) const {
    return readings_[i].time - readings_[i - 1].time;
  }

  // Finds the reading before `time`.
  void find(const Instant& time) {
    const auto comes_after = [&](std::size_t i) { return time < readings_[i].time; };
    if (comes_after(last_) || (last_ + 3 < size() && !comes_after(last_ + 2))) {
      const auto after = std::upper_bound(
          readings_.begin(), readings_.end(), time,
          [](const Instant& t, const Reading& reading) { return t < reading.time; });
      last_ = static_cast<std::size_t>(after - readings_.begin()) - 1;
    } else {
      while (last_ + 2 < size() && !comes_after(last_ + 1))
        ++last_;
    }
    last_ = std::min(last_, size() - 2);
  }

  // Second derivatives of the spline through readings `first` to before `end`, which have no hole
  // between them; at both ends those of the cubic through the nearest four.
  void bend(std::size_t first, std::size_t end) {
    constexpr std::size_t fewest_readings = 5;
    if (end - first < fewest_readings) return;
    bend_[first] = end_bend(first, first + 1, first + 2, first + 3);
    bend_[end - 1] = end_bend(end - 1, end - 2, end - 3, end - 4);
    // Elimination of the tridiagonal equations that make the slope continuous.
    std::vector<double> above(end - first, 0.0);
    double carried = bend_[first];
    for (std::size_t i = first + 1; i + 1 < end; ++i) {
      const double before = step(i), after = step(i + 1);
      const double jump = (readings_[i + 1].value - readings_[i].value) / after -
                          (readings_[i].value - readings_[i - 1].value) / before;
      const double pivot = 2.0 * (before + after) - before * above[i - first - 1];
      above[i - first] = after / pivot;
      carried = bend_[i] = (6.0 * jump - before * carried) / pivot;
    }
    for (std::size_t i = end - 2; i > first; --i)
      bend_[i] -= above[i - first] * bend_[i + 1];
  }

  // The second derivative, at reading a, of the cubic through four readings: from divided
  // differences.
  [[nodiscard]] double end_bend(std::size_t a, std::size_t b, std::size_t c, std::size_t d) const {
    const auto t = [&](std::size_t i) { return readings_[i].time - readings_[a].time; };
    const auto slope = [&](std::size_t i, std::size_t k) {
      return (readings_[k].value - readings_[i].value) / (t(k) - t(i));
    };
    const double second = (slope(b, c) - slope(a, b)) / t(c);
    const double third = ((slope(c, d) - slope(b, c)) / (t(d) - t(b)) - second) / t(d);
    return 2.0 * (second - third * (t(b) + t(c)));
  }

  // The departures of readings from the polynomial through `reach` neighbours on either side.
  [[nodiscard]] double left_out_rms(std::size_t reach) const {
    double sum2 = 0.0, count = 0.0;
    for (std::size_t i = reach; i + reach < size(); ++i) {
      bool has_hole = false;
      for (std::size_t k = i - reach + 1; k <= i + reach; ++k)
        has_hole = has_hole || is_hole(readings_[k - 1], readings_[k]);
      if (has_hole) continue;
      const double d = readings_[i].value - predicted(i, reach);
      sum2 += d * d;
      ++count;
    }
    return count > 0.0 ? std::sqrt(sum2 / count) : not_known;
  }

  // Lagrange's polynomial through the neighbours of reading i, at i.
  [[nodiscard]] double predicted(std::size_t i, std::size_t reach) const {
    double sum = 0.0;
    for (std::size_t a = i - reach; a <= i + reach; ++a) {
      if (a == i) continue;
      double weight = 1.0;
      for (std::size_t k = i - reach; k <= i + reach; ++k)
        if (k != a && k != i)
          weight *= (readings_[i].time - readings_[k].time) /
                    (readings_[a].time - readings_[k].time);
      sum += weight * readings_[a].value;
    }
    return sum;
  }

  std::vector<Reading> readings_;
  std::vector<double> bend_; // second derivative at each; 0: straight lines
  double step_s_ = 0.0, sigma_ = not_known;
  std::size_t last_ = 0; // the reading before the time asked for last
};

std::vector<Reading> readings_of(const ClockLog& file, const WeatherQuantity& quantity) {
  const std::vector<double>& values = file.columns.*quantity.values;
  std::vector<Reading> readings;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values[i])) readings.push_back({file.events[i].time, values[i]});
  if (readings.empty() && !values.empty())
    throw InputError(file.place(file.events.front().line),
                     fmt::format("{} lines without {}", values.size(), quantity.article_and_name),
                     "readings below its name");
  std::stable_sort(readings.begin(), readings.end(),
                   [](const Reading& a, const Reading& b) { return a.time < b.time; });
  const auto repeated =
      std::unique(readings.begin(), readings.end(),
                  [](const Reading& a, const Reading& b) { return a.time == b.time; });
  readings.erase(repeated, readings.end());
  const double step_s = usual_step(readings);
  for (Reading& reading : readings)
    reading.usual_step_s = step_s;
  return readings;
}

class Joining {
public:
  Joining(ClockLog& log, const WeatherRequest& request) : log_(log), request_(request) {
    constexpr double largest_offset_s = 1e9;
    const auto zone = zone_named(request.zone);
    if (!zone && !request.zone.empty())
      throw ArgumentError("weather-zone", request.zone, "an offset such as +01:00, or Z");
    zone_s_ = zone ? static_cast<double>(*zone) : log.zone_s.value_or(0.0);
    if (!(std::abs(request.offset_s) <= largest_offset_s))
      throw ArgumentError("weather-offset", request.offset_s, "between -1e9 and 1e9 s");
  }

  void run() {
    for (const std::string& path : request_.files)
      files_.push_back(read(path));
    for (const WeatherQuantity& quantity : weather_quantities)
      join(quantity);
  }

private:
  ClockLog read(const std::string& path) const {
    ReadingOptions options;
    options.weather = true;
    options.zone_s = zone_s_;
    ClockLog file = read_log_file(path, options);
    if (file.origin == TimeOrigin::epoch && !file.zone_s && request_.zone.empty())
      log_.assumptions.push_back(
          {fmt::format("{}: its dates are in the zone of the log's", path), Setting::weather_zone});
    for (const Assumption& assumption : file.assumptions)
      log_.assumptions.push_back({fmt::format("{}: {}", path, assumption.text)});
    for (LineIssue& issue : file.issues)
      log_.assumptions.push_back({fmt::format("{}:{}:{}: {}: {}", path, issue.line, issue.column,
                                              issue.found, issue.action)});
    bring_to_origin(file);
    return file;
  }

  // Converts times of the weather to the log's origin.
  void bring_to_origin(ClockLog& file) const {
    if ((file.origin == TimeOrigin::none) != (log_.origin == TimeOrigin::none))
      throw InputError(file.place(file.events.front().line), times_of(file.origin),
                       fmt::format("{}, as in {}", times_of(log_.origin), log_.source));
    const std::int64_t shift = seconds_before_1970(log_.origin) - seconds_before_1970(file.origin);
    for (Beat& reading : file.events) {
      reading.time.seconds += shift;
      reading.time = reading.time + request_.offset_s;
    }
  }

  void join(const WeatherQuantity& quantity) {
    std::vector<Reading> readings;
    std::vector<std::string> sources;
    for (const ClockLog& file : files_) {
      std::vector<Reading> more = readings_of(file, quantity);
      if (more.empty()) continue;
      sources.push_back(file.source);
      add(readings, more, file, sources.front());
    }
    if (sources.empty()) return;
    const std::string_view name = name_of(quantity.role);
    if (!(log_.columns.*quantity.values).empty())
      throw InputError({sources.front()}, fmt::format("a {}", name),
                       fmt::format("none: {} has a {} of its own", log_.source, name));
    if (readings.size() < 2)
      throw InputError({sources.front()}, fmt::format("one reading of the {}", name),
                       "at least two");
    put(quantity, ReadingsCurve(std::move(readings)),
        sources.size() == 1 ? sources.front()
                            : fmt::format("{} and {} more", sources.front(), sources.size() - 1));
  }

  static void add(std::vector<Reading>& readings, const std::vector<Reading>& more,
                  const ClockLog& file, const std::string& first) {
    const bool before = readings.empty() || more.back().time < readings.front().time;
    const bool after = !readings.empty() && readings.back().time < more.front().time;
    if (!before && !after)
      throw InputError(file.place(file.events.front().line),
                       fmt::format("times that overlap those of {}", first),
                       "files of one sensor, one after the other");
    readings.insert(before ? readings.begin() : readings.end(), more.begin(), more.end());
  }

  void put(const WeatherQuantity& quantity, ReadingsCurve curve, std::string source) {
    JoinedWeather joined{std::string(name_of(quantity.role)), std::move(source), curve.size(),
                         curve.step_s(), curve.sigma(), 0};
    std::vector<double>& values = log_.columns.*quantity.values;
    values.reserve(log_.events.size());
    for (const Beat& event : log_.events) {
      values.push_back(curve.at(event.time));
      joined.events_without += std::isnan(values.back()) ? 1 : 0;
    }
    if (joined.events_without == values.size())
      throw InputError({joined.source}, fmt::format("no {} beside the log", joined.quantity),
                       "readings from before its first beat to after its last; another zone or "
                       "offset of the weather may bring them together");
    log_.assumptions.push_back({words_for(joined, quantity.unit)});
    log_.weather.push_back(std::move(joined));
  }

  [[nodiscard]] std::string words_for(const JoinedWeather& joined, std::string_view unit) const {
    std::string text =
        fmt::format("{} from {}, {} readings, usually every {:.6g} s; interpolated", joined.quantity,
                    joined.source, joined.readings, joined.step_s);
    if (!std::isnan(joined.sigma)) text += fmt::format(" with ±{:.2g} {}", joined.sigma, unit);
    if (joined.events_without > 0)
      text += fmt::format("; {} of {} events stand in holes or outside, and have none",
                          joined.events_without, log_.events.size());
    return text;
  }

  ClockLog& log_;
  const WeatherRequest& request_;
  double zone_s_ = 0.0; // east of Greenwich
  std::vector<ClockLog> files_;
};

} // namespace

void join_weather(ClockLog& log, const WeatherRequest& request) {
  if (!request.files.empty()) Joining(log, request).run();
}

} // namespace goingrate

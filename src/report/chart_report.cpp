#include "goingrate/report/chart_report.hpp"

#include "base/scaled_time.hpp"
#include "json_parts.hpp"
#include "markup.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>

namespace goingrate {

namespace {

// An error of exactly 0 is smaller than the oracle's 64 bits can show.
constexpr double smallest_error = 1e-19;

std::vector<std::string> scenes_of(const std::vector<ChartRow>& rows) {
  std::vector<std::string> names;
  for (const ChartRow& row : rows)
    if (std::find(names.begin(), names.end(), row.scenario) == names.end())
      names.push_back(row.scenario);
  return names;
}

bool same_method(const ChartRow& a, const ChartRow& b) {
  return a.method == b.method && a.setting == b.setting;
}

} // namespace

std::string chart_text(const std::vector<ChartRow>& rows, double nominal_period_s) {
  std::string text;
  auto out = std::back_inserter(text);
  for (const std::string& scene : scenes_of(rows)) {
    const auto frontier = chart_frontier(rows, scene);
    std::vector<ChartRow> mine;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(mine),
                 [&](const ChartRow& row) { return row.scenario == scene; });
    std::stable_sort(mine.begin(), mine.end(), [](const auto& a, const auto& b) {
      return a.status == SwingStatus::crossed &&
             (b.status != SwingStatus::crossed || a.ns_per_period < b.ns_per_period);
    });
    fmt::format_to(out, "{}\n  {:<15} {:<29} {:>12} {:>10} {:>11} {:>11}\n", scene, "method",
                   "setting", "ns per period", "setup us", "max error", "seconds");
    for (const ChartRow& row : mine) {
      if (row.status != SwingStatus::crossed) {
        fmt::format_to(out, "  {:<15} {:<29} {}\n", row.method, row.setting, words_for(row.status));
        continue;
      }
      const bool best = std::any_of(frontier.begin(), frontier.end(),
                                    [&](const auto& f) { return same_method(f, row); });
      fmt::format_to(out, "{} {:<15} {:<29} {:>12.1f} {:>10.1f} {:>11.1e} {:>11.1e}\n",
                     best ? '*' : ' ', row.method, row.setting, row.ns_per_period, row.setup_us,
                     row.max_error, row.max_error * nominal_period_s / two_pi);
    }
    text += '\n';
  }
  fmt::format_to(out,
                 "times are of the processor; max error: of a crossing time, scaled (T0 = 2 pi); "
                 "seconds: the same for T0 = {} s.\n* no other method is both faster and closer.\n",
                 nominal_period_s);
  return text;
}

std::string chart_json(const std::vector<ChartRow>& rows) {
  Json json = json_with_schema("goingrate.chart");
  json["rows"] = Json::array();
  for (const ChartRow& row : rows)
    json["rows"].push_back({{"method", row.method},
                            {"setting", row.setting},
                            {"scenario", row.scenario},
                            {"ns_per_period", json_number(row.ns_per_period)},
                            {"max_error", json_number(row.max_error)},
                            {"setup_us", json_number(row.setup_us)},
                            {"status", std::string(words_for(row.status))}});
  return json.dump(1) + '\n';
}

Figure chart_figure(const std::vector<ChartRow>& rows, const std::string& scene,
                    double nominal_period_s, double jitter_s) {
  Figure figure;
  figure.id = "chart";
  figure.title = fmt::format("Speed and accuracy: {}", scene);
  figure.caption = "Largest error of a crossing time against the time a period takes.";
  figure.x = {"time per period", "ns", true};
  figure.y = {"largest error", "s", true};
  const double to_seconds = nominal_period_s / two_pi;
  const auto error_s = [&](const ChartRow& row) {
    return std::max(row.max_error, smallest_error) * to_seconds;
  };
  Series frontier{Series::Style::line, "nothing is faster and closer", {}, {}, {}, {}, 7};
  for (const ChartRow& row : chart_frontier(rows, scene)) {
    frontier.x.push_back(row.ns_per_period);
    frontier.y.push_back(error_s(row));
  }
  figure.series.push_back(frontier);
  double fastest = 1e300, slowest = 0.0;
  for (const ChartRow& row : rows) {
    if (row.scenario != scene || row.status != SwingStatus::crossed) continue;
    fastest = std::min(fastest, row.ns_per_period);
    slowest = std::max(slowest, row.ns_per_period);
    const auto is_mine = [&](const Series& s) { return s.label == row.method; };
    if (std::none_of(figure.series.begin(), figure.series.end(), is_mine)) {
      const int colour = static_cast<int>(figure.series.size() - 1) % 7;
      figure.series.push_back({Series::Style::points, row.method, {}, {}, {}, {}, colour});
    }
    Series& series = *std::find_if(figure.series.begin(), figure.series.end(), is_mine);
    series.x.push_back(row.ns_per_period);
    series.y.push_back(error_s(row));
  }
  if (jitter_s > 0.0)
    figure.series.push_back({Series::Style::line,
                             fmt::format("jitter of the sensor, {:g} s", jitter_s),
                             {fastest, slowest},
                             {jitter_s, jitter_s},
                             {},
                             {},
                             6});
  return figure;
}

std::string limits_text(const std::vector<LimitRow>& rows) {
  std::string text = "error of the last crossing time, relative to the length of the run; the "
                     "first method above 1e-6\n        ε    λ/φ0   amplitude";
  auto out = std::back_inserter(text);
  if (!rows.empty())
    for (const auto& error : rows.front().errors)
      fmt::format_to(out, " {:>16}", error.method);
  text += "  breaks\n";
  for (const LimitRow& row : rows) {
    fmt::format_to(out, "{:>9.0e} {:>7.2f} {:>11.2f}", row.epsilon, row.ratio, row.amplitude);
    for (const auto& error : row.errors)
      fmt::format_to(out, " {:>16}",
                     error.status != SwingStatus::crossed ? std::string(short_name(error.status))
                     : std::isfinite(error.error)         ? fmt::format("{:.1e}", error.error)
                                                          : std::string("goes on"));
    fmt::format_to(out, "  {}\n", row.breaks);
  }
  return text;
}

std::string limits_json(const std::vector<LimitRow>& rows) {
  Json json = json_with_schema("goingrate.limits");
  json["rows"] = Json::array();
  for (const LimitRow& row : rows) {
    Json errors = Json::array();
    for (const auto& error : row.errors)
      errors.push_back({{"method", error.method},
                        {"status", std::string(short_name(error.status))},
                        {"error", json_number(error.error)}});
    json["rows"].push_back({{"epsilon", row.epsilon},
                            {"ratio", row.ratio},
                            {"amplitude_rad", row.amplitude},
                            {"exact", std::string(short_name(row.exact))},
                            {"errors", errors},
                            {"breaks", row.breaks}});
  }
  return json.dump(1) + '\n';
}

// ---- stationary operation -----------------------------------------------------------------------

std::string rate_map_table(const RateMap& map) {
  std::string text = "epsilon,mu,rate_excess,rate_s_per_day\n";
  for (std::size_t j = 0; j < map.mu.size(); ++j)
    for (std::size_t i = 0; i < map.epsilon.size(); ++i) {
      const double rate = map.rate_excess[j][i];
      fmt::format_to(std::back_inserter(text), "{},{},", map.epsilon[i], map.mu[j]);
      if (std::isfinite(rate))
        fmt::format_to(std::back_inserter(text), "{},{}\n", rate, seconds_gained_per_day(rate));
      else
        text += ",\n"; // stalled: no rate
    }
  return text;
}

std::string rate_map_json(const RateMap& map) {
  Json json = json_with_schema("goingrate.map");
  json["phi0"] = map.phi0;
  json["epsilon"] = map.epsilon;
  json["mu"] = map.mu;
  json["rate_excess"] = Json::array();
  for (const auto& row : map.rate_excess) {
    Json values = Json::array();
    for (const double rate : row)
      values.push_back(json_number(rate));
    json["rate_excess"].push_back(values);
  }
  return json.dump() + '\n';
}

namespace {

// The curves are steep where a rate is more than three times as far from the highest rate as the
// median rate is.
double lowest_of_interest(const RateMap& map) {
  std::vector<double> rates;
  for (const auto& row : map.rate_excess)
    std::copy_if(row.begin(), row.end(), std::back_inserter(rates),
                 [](double rate) { return std::isfinite(rate); });
  if (rates.empty()) return -INFINITY;
  const auto middle = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2);
  std::nth_element(rates.begin(), middle, rates.end());
  const double highest = *std::max_element(middle, rates.end());
  return highest - 3.0 * (highest - *middle);
}

Series curve_of_torque(const RateMap& map, std::size_t j, double lowest) {
  Series curve{Series::Style::line, "μ = " + plain_number(map.mu[j]), map.epsilon, {}, {}, {}};
  for (const double rate : map.rate_excess[j])
    curve.y.push_back(rate >= lowest ? seconds_gained_per_day(rate)
                                     : std::numeric_limits<double>::quiet_NaN());
  return curve;
}

Figure rates_above(const RateMap& map, double lowest, const std::vector<OperatingPoint>& points) {
  constexpr std::array colours{0, 1, 2, 3, 4, 5, 7}; // yellow is too pale for a line
  const std::size_t lines = std::min(colours.size(), map.mu.size());
  Figure figure;
  figure.id = "map";
  figure.title = "Stationary rate";
  figure.caption = fmt::format("The rate of a clock with escapement angle {:g} rad against its "
                               "friction; a line ends where the clock stalls.",
                               map.phi0);
  figure.x = {"friction ε", "", true};
  figure.y = {"rate", "s/day"};
  figure.group = "map";
  for (std::size_t k = 0; k < lines; ++k) {
    const std::size_t j = lines == 1 ? 0 : k * (map.mu.size() - 1) / (lines - 1);
    figure.series.push_back(curve_of_torque(map, j, lowest));
    figure.series.back().colour = colours[k];
  }
  Series marks{Series::Style::points, "operating point", {}, {}, {}, {}, 7};
  for (const OperatingPoint& point : points) {
    if (point.rate_excess < lowest) continue;
    marks.x.push_back(point.epsilon);
    marks.y.push_back(seconds_gained_per_day(point.rate_excess));
  }
  if (!marks.x.empty()) figure.series.push_back(std::move(marks));
  return figure;
}

} // namespace

std::vector<Figure> rate_map_figures(const RateMap& map,
                                     const std::vector<OperatingPoint>& points) {
  std::vector<Figure> figures{rates_above(map, -INFINITY, points)};
  const double lowest = lowest_of_interest(map);
  double least = INFINITY;
  for (const auto& row : map.rate_excess)
    for (const double rate : row)
      if (rate < least) least = rate;
  if (!(least < 3.0 * lowest)) return figures;
  figures.push_back(rates_above(map, lowest, points));
  figures.back().id = "map-near";
  figures.back().title = "Stationary rate, near the nominal";
  return figures;
}

namespace {

// limit_cycle's rate is good to 1e-15.
double without_rounding(double rate_excess) {
  return std::abs(rate_excess) < 1e-15 ? 0.0 : rate_excess;
}

} // namespace

std::string operating_points_text(const std::vector<OperatingPoint>& points, double phi0) {
  std::string text = fmt::format("φ0 = {} rad\n  {:<14} {:<14} {:<16} {:<14} {}\n", phi0, "ε", "μ",
                                 "amplitude/rad", "rate/(s/day)", "rate excess");
  for (const OperatingPoint& point : points) {
    const double rate = without_rounding(point.rate_excess);
    fmt::format_to(std::back_inserter(text), "  {:<14.8g} {:<14.8g} {:<16.10g} {:<14} {}\n",
                   point.epsilon, point.mu, point.amplitude,
                   rate == 0.0 ? "0" : fmt::format("{:+.8g}", seconds_gained_per_day(rate)),
                   rate == 0.0 ? "0" : fmt::format("{:+.10g}", rate));
  }
  return text;
}

std::string operating_points_json(const std::vector<OperatingPoint>& points, double phi0) {
  Json json = json_with_schema("goingrate.operating_points");
  json["phi0"] = phi0;
  json["points"] = Json::array();
  for (const OperatingPoint& point : points)
    json["points"].push_back({{"epsilon", point.epsilon},
                              {"mu", point.mu},
                              {"amplitude_rad", point.amplitude},
                              {"rate_excess", point.rate_excess}});
  return json.dump(1) + '\n';
}

} // namespace goingrate

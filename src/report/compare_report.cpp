#include "goingrate/report/compare_report.hpp"

#include "json_parts.hpp"
#include "wording.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr int column_width = 11; // of a column of deviations

std::string letter(std::size_t clock) { return fmt::format("{}", clock + 1); }

std::string name_of_pair(const ClockPair& pair) {
  return letter(pair.first) + "−" + letter(pair.second);
}

std::string cell(double value) {
  return std::isfinite(value) ? fmt::format(" {:>{}.3e}", value, column_width)
                              : fmt::format(" {:>{}}", "–", column_width);
}

std::string going(const RateSummary& rate) {
  if (!rate.nominal_is_known)
    return fmt::format("a mean period of {} s, its rate not known without a nominal period",
                       with_sigma(rate.mean_period_s, rate.mean_period_sigma_s, 12));
  return fmt::format("{} {} s/day", rate.rate_excess < 0.0 ? "loses" : "gains",
                     with_sigma(seconds_per_day * std::abs(rate.rate_excess),
                                seconds_per_day * rate.rate_excess_sigma));
}

std::string clocks_text(const Comparison& comparison) {
  std::string text;
  for (std::size_t i = 0; i < comparison.clocks.size(); ++i) {
    const ComparedClock& clock = comparison.clocks[i];
    text += fmt::format("{} {}: {} over {} beats\n", letter(i), file_name(clock.source),
                        going(clock.rate), clock.rate.crossings);
    for (const WeatherPart& part : clock.weather)
      text += fmt::format("    {} s/day per {} of {}\n",
                          with_sigma(seconds_per_day * part.coefficient,
                                     seconds_per_day * part.sigma),
                          part.unit.substr(part.unit.find('/') + 1), part.name);
  }
  return text;
}

std::string deviations_text(const Comparison& comparison, std::string_view title,
                            DeviationTable ComparedClock::*of_clock,
                            DeviationTable ClockPair::*of_pair) {
  std::string text = fmt::format("\n{}\n", title);
  text += fmt::format("{:>9}", "τ/s");
  for (std::size_t i = 0; i < comparison.clocks.size(); ++i)
    text += fmt::format(" {:>{}}", letter(i), column_width);
  for (const ClockPair& pair : comparison.pairs)
    text += fmt::format(" {:>{}}", name_of_pair(pair), column_width);
  text += '\n';
  const auto& rows = comparison.clocks.front().deviation.rows;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += fmt::format("{:>9.6g}", rows[r].tau_s);
    for (const ComparedClock& clock : comparison.clocks) // without weather nothing was subtracted
      text += cell(((clock.*of_clock).rows.empty() ? clock.deviation : clock.*of_clock).rows[r].value);
    for (const ClockPair& pair : comparison.pairs)
      text += cell((pair.*of_pair).rows[r].value);
    text += '\n';
  }
  return text;
}

std::string correlations_text(const Comparison& comparison) {
  std::string text = "\nCorrelation of the rates, means over ";
  const double block_s = comparison.step_s *
                         static_cast<double>(comparison.clocks.front().error_s.size() - 1) /
                         static_cast<double>(comparison.blocks);
  text += fmt::format("{:.4g} s:", block_s);
  for (const ClockPair& pair : comparison.pairs)
    text += std::isnan(pair.correlation)
                ? fmt::format(" {}: –", name_of_pair(pair))
                : fmt::format(" {}: {:+.2f}", name_of_pair(pair), pair.correlation);
  return text + '\n';
}

std::string hat_text(const std::vector<HatRow>& rows, std::string_view title) {
  if (rows.empty()) return {};
  std::string text = fmt::format("\n{}\n{:>9}", title, "τ/s");
  constexpr int value_columns = 20;
  for (std::size_t i = 0; i < rows.front().clocks.size(); ++i)
    text += fmt::format(" {:>{}}", letter(i), value_columns);
  text += '\n';
  for (const HatRow& row : rows) {
    text += fmt::format("{:>9.6g}", row.tau_s);
    for (const HatEstimate& clock : row.clocks) {
      const double value = std::sqrt(std::max(0.0, clock.variance));
      text += fmt::format(" {:>{}}",
                          clock.is_resolved()
                              ? fmt::format("{:.2e} ± {:.0e}", value, 0.5 * clock.sigma / value)
                          : std::isfinite(clock.upper_limit)
                              ? fmt::format("below {:.2e}", clock.upper_limit)
                              : "not known",
                          value_columns);
    }
    text += '\n';
  }
  return text;
}

std::string warning_of_company(const Comparison& comparison) {
  constexpr double shared_correlation = 0.5;
  std::string text;
  for (const ClockPair& pair : comparison.pairs)
    if (!comparison.hat.empty() && std::abs(pair.correlation) > shared_correlation)
      text += fmt::format("{} and {} vary together, and this table does not hold for them as it "
                          "stands: weather that is logged is taken off.\n",
                          letter(pair.first), letter(pair.second));
  return text;
}

Json hat_object(const std::vector<HatRow>& rows) {
  Json json = Json::array();
  for (const HatRow& row : rows) {
    Json clocks = Json::array();
    for (const HatEstimate& clock : row.clocks)
      clocks.push_back({{"variance", json_number(clock.variance)},
                        {"sigma", json_number(clock.sigma)},
                        {"resolved", clock.is_resolved()},
                        {"deviation_below_95", json_number(clock.upper_limit)}});
    json.push_back({{"tau_s", row.tau_s}, {"clocks", std::move(clocks)}});
  }
  return json;
}

Json clock_object(const ComparedClock& clock) {
  Json weather = Json::array();
  for (const WeatherPart& part : clock.weather)
    weather.push_back({{"name", part.name},
                       {"unit", part.unit},
                       {"coefficient", json_number(part.coefficient)},
                       {"sigma", json_number(part.sigma)}});
  const auto known = [&](double rate) {
    return clock.rate.nominal_is_known ? json_number(rate) : Json(nullptr);
  };
  Json json{{"source", clock.source},
            {"nominal_period_s", clock.rate.nominal_period_s},
            {"crossings", clock.rate.crossings},
            {"nominal_period_is_known", clock.rate.nominal_is_known},
            {"mean_period_s", json_number(clock.rate.mean_period_s)},
            {"rate_excess", known(clock.rate.rate_excess)},
            {"rate_excess_sigma", known(clock.rate.rate_excess_sigma)},
            {"rate_s_per_day", known(seconds_per_day * clock.rate.rate_excess)},
            {"weather", std::move(weather)},
            {"stability", stability_object(clock.deviation)}};
  if (!clock.own_error_s.empty())
    json["stability_without_weather"] = stability_object(clock.own_deviation);
  return json;
}

double middle_of_block(const Comparison& comparison, std::size_t block) {
  const std::size_t last = comparison.clocks.front().error_s.size() - 1;
  const std::size_t from = block * last / comparison.blocks,
                    to = (block + 1) * last / comparison.blocks;
  return 0.5 * comparison.step_s * static_cast<double>(from + to);
}

std::vector<double> rates_of(const Comparison& comparison, const ComparedClock& clock) {
  std::vector<double> rates = block_rates_of(clock.error_s, comparison.step_s, comparison.blocks);
  for (double& rate : rates)
    rate *= seconds_per_day;
  return rates;
}

void add_deviation(const DeviationTable& table, std::string label, int colour, Figure& figure) {
  Series line{Series::Style::line, std::move(label), {}, {}, {}, {}, colour};
  for (const DeviationRow& row : table.rows) {
    if (!std::isfinite(row.value)) continue;
    line.x.push_back(row.tau_s);
    line.y.push_back(row.value);
  }
  figure.series.push_back(std::move(line));
}

} // namespace

std::string compare_text(const Comparison& comparison) {
  const bool has_weather = !comparison.pairs.front().own_deviation.rows.empty();
  return clocks_text(comparison) +
         deviations_text(comparison, "Allan deviation of each, and of the differences",
                         &ComparedClock::deviation, &ClockPair::deviation) +
         (has_weather ? deviations_text(comparison, "The same without the weather",
                                        &ComparedClock::own_deviation, &ClockPair::own_deviation)
                      : "") +
         correlations_text(comparison) +
         hat_text(comparison.hat, "Allan deviation of each clock alone, by the differences, if their "
                                  "noises are independent") +
         warning_of_company(comparison) +
         hat_text(comparison.own_hat, "Each clock alone, without the weather");
}

std::string compare_json(const Comparison& comparison) {
  Json json = json_with_schema("goingrate.compare");
  json["start_s"] = format_instant(comparison.start, 9);
  json["step_s"] = comparison.step_s;
  json["common_s"] =
      comparison.step_s * static_cast<double>(comparison.clocks.front().error_s.size() - 1);
  json["clocks"] = Json::array();
  for (const ComparedClock& clock : comparison.clocks)
    json["clocks"].push_back(clock_object(clock));
  json["differences"] = Json::array();
  for (const ClockPair& pair : comparison.pairs) {
    Json difference{{"clocks", {pair.first + 1, pair.second + 1}},
                    {"rate_correlation", json_number(pair.correlation)},
                    {"stability", stability_object(pair.deviation)}};
    if (!pair.own_deviation.rows.empty())
      difference["stability_without_weather"] = stability_object(pair.own_deviation);
    json["differences"].push_back(std::move(difference));
  }
  json["alone"] = hat_object(comparison.hat);
  json["alone_without_weather"] = hat_object(comparison.own_hat);
  return json_text(json);
}

std::string compare_table(const Comparison& comparison) {
  std::string text = "time_s";
  std::vector<std::vector<double>> rates;
  for (std::size_t i = 0; i < comparison.clocks.size(); ++i) {
    text += fmt::format(",rate_{}_s_per_day", i + 1);
    rates.push_back(rates_of(comparison, comparison.clocks[i]));
  }
  text += '\n';
  for (std::size_t b = 0; b < comparison.blocks; ++b) {
    text += fmt::format("{:.6g}", middle_of_block(comparison, b));
    for (const std::vector<double>& rate : rates)
      text += std::isnan(rate[b]) ? "," : fmt::format(",{:.6g}", rate[b]);
    text += '\n';
  }
  return text;
}

std::vector<Figure> compare_figures(const Comparison& comparison) {
  Figure rates{"compare-rates",
               "Rates of the clocks",
               "Mean rates in blocks of equal time: where lines move together, something acts on "
               "all clocks, as the weather does, or the time they are compared with is off.",
               {"time since the first common beat", "s"},
               {"rate", "s/day"},
               {}};
  Figure deviations{"compare-deviation",
                    "Stability of the clocks and of their differences",
                    "A difference that lies below both of its clocks shows that they move together.",
                    {"averaging time τ", "s", true},
                    {"overlapping Allan deviation", "", true},
                    {}};
  const auto unit = time_unit(comparison.step_s *
                              static_cast<double>(comparison.clocks.front().error_s.size()));
  rates.x.unit = unit.name;
  int colour = 0;
  constexpr int colours = 8;
  for (const ComparedClock& clock : comparison.clocks) {
    Series line{Series::Style::line, file_name(clock.source), {}, rates_of(comparison, clock), {},
                {}, colour};
    for (std::size_t b = 0; b < comparison.blocks; ++b)
      line.x.push_back(unit.factor * middle_of_block(comparison, b));
    rates.series.push_back(std::move(line));
    add_deviation(clock.deviation, file_name(clock.source), colour, deviations);
    colour = (colour + 1) % colours;
  }
  for (const ClockPair& pair : comparison.pairs) {
    add_deviation(pair.deviation, name_of_pair(pair), colour, deviations);
    colour = (colour + 1) % colours;
  }
  return {std::move(rates), std::move(deviations)};
}

} // namespace goingrate

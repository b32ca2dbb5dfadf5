#include "goingrate/report/batch_report.hpp"

#include "goingrate/report/tables.hpp"
#include "json_parts.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

namespace {

constexpr std::size_t failures_shown = 10; // realisations only; a log that fails has its own row

std::string number(double value, const char* format) {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

std::string counts(const std::map<std::string, std::size_t>& named) {
  std::string text;
  for (const auto& [name, count] : named)
    text += fmt::format("  {:>7} {}\n", count, name);
  return text;
}

std::string head_text(const BatchSummary& summary) {
  std::string text = fmt::format("Batch {}: {}\n", summary.batch, summary.command);
  if (!summary.scenario.empty() && summary.jobs > 0)
    text += fmt::format("Scenario {}, seeds {} to {}\n", summary.scenario, summary.first_seed,
                        summary.first_seed + summary.jobs - 1);
  const auto done = summary.exits.find(0);
  const std::size_t whole = done == summary.exits.end() ? 0 : done->second;
  text += fmt::format("{} jobs, {} of them failed", summary.jobs, summary.jobs - whole);
  const char* between = " (";
  for (const auto& [code, count] : summary.exits) {
    if (code == 0) continue;
    text += fmt::format("{}exit {}: {}", between, code, count);
    between = ", ";
  }
  return text + (whole == summary.jobs ? "\n" : ")\n");
}

std::string parameters_text(const BatchSummary& summary) {
  if (summary.parameters.empty()) return {};
  std::string text = fmt::format("\n{:<14} {:>12} {:>10} {:>6} {:>6} {:>9} {:>7} {:>9} {:>9}\n",
                                 "parameter", "truth", "determined", "68 %", "95 %", "mean pull",
                                 "sd pull", "sigma", "/scatter");
  for (const ParameterScore& p : summary.parameters)
    fmt::format_to(
        std::back_inserter(text), "{:<14} {:>12} {:>10} {:>6} {:>6} {:>9} {:>7} {:>9} {:>9}\n",
        p.name, number(p.truth, "{:.6g}"), p.determined, number(p.within68, "{:.3f}"),
        number(p.within95, "{:.3f}"), number(p.mean_pull, "{:.3f}"), number(p.sd_pull, "{:.3f}"),
        number(p.median_sigma, "{:.2g}"), number(p.median_sigma / p.scatter, "{:.3f}"));
  return text;
}

std::string deviations_text(const BatchSummary& summary) {
  if (summary.deviations.empty()) return {};
  std::string text = fmt::format("\n{:>12} {:>8} {:>11} {:>11} {:>11}\n", "tau, s", "jobs", "16 %",
                                 "median", "84 %");
  for (const DeviationScore& d : summary.deviations)
    fmt::format_to(std::back_inserter(text), "{:>12.6g} {:>8} {:>11} {:>11} {:>11}\n", d.tau_s,
                   d.jobs, number(d.low, "{:.3e}"), number(d.median, "{:.3e}"),
                   number(d.high, "{:.3e}"));
  return text;
}

std::string row_text(const JobRow& row, std::size_t width) {
  const std::string rate = std::isfinite(row.rate_s_per_day) && row.sigma > 0.0
                               ? with_sigma(row.rate_s_per_day, row.sigma)
                               : number(row.rate_s_per_day, "{:.6g}");
  const std::string words =
      row.exit_code == 0 ? row.words : fmt::format("exit {}: {}", row.exit_code, row.words);
  return fmt::format("{:<{}}  {:>22}  {}\n", row.subject, width, rate, words);
}

std::string rows_text(const BatchSummary& summary) {
  const bool logs = summary.scenario.empty();
  std::size_t width = 3, left_out = 0, shown = 0;
  for (const JobRow& row : summary.rows)
    width = std::max(width, row.subject.size());
  std::string text;
  for (const JobRow& row : summary.rows) {
    if (!logs && row.exit_code == 0) continue;
    if (logs || ++shown <= failures_shown)
      text += row_text(row, width);
    else
      ++left_out;
  }
  if (text.empty()) return {};
  if (left_out > 0) text += fmt::format("... and {} more that failed\n", left_out);
  return fmt::format("\n{:<{}}  {:>22}  {}\n", logs ? "log" : "job", width, "rate, s/day",
                     "status") +
         text;
}

} // namespace

std::string batch_text(const BatchSummary& summary) {
  return head_text(summary) + counts(summary.statuses) + counts(summary.models) +
         parameters_text(summary) + deviations_text(summary) + rows_text(summary);
}

std::string batch_json(const BatchSummary& summary) {
  Json json = json_with_schema("goingrate.batch-summary");
  json["batch"] = summary.batch;
  json["command"] = summary.command;
  if (!summary.scenario.empty())
    json["scenario"] = {{"hash", summary.scenario}, {"seed", summary.first_seed}};
  json["jobs"] = summary.jobs;
  json["exits"] = Json::object();
  for (const auto& [code, count] : summary.exits)
    json["exits"][fmt::format("{}", code)] = count;
  json["statuses"] = summary.statuses;
  json["models"] = summary.models;
  json["parameters"] = Json::array();
  for (const ParameterScore& p : summary.parameters)
    json["parameters"].push_back({{"name", p.name},
                                  {"truth", json_number(p.truth)},
                                  {"determined", p.determined},
                                  {"undetermined", p.undetermined},
                                  {"within68", json_number(p.within68)},
                                  {"within95", json_number(p.within95)},
                                  {"mean_pull", json_number(p.mean_pull)},
                                  {"sd_pull", json_number(p.sd_pull)},
                                  {"median", json_number(p.median)},
                                  {"median_sigma", json_number(p.median_sigma)},
                                  {"scatter", json_number(p.scatter)},
                                  {"rms_error", json_number(p.rms_error)}});
  json["deviations"] = Json::array();
  for (const DeviationScore& d : summary.deviations)
    json["deviations"].push_back({{"tau_s", json_number(d.tau_s)},
                                  {"jobs", d.jobs},
                                  {"median", json_number(d.median)},
                                  {"low", json_number(d.low)},
                                  {"high", json_number(d.high)}});
  json["rows"] = Json::array();
  for (const JobRow& row : summary.rows)
    json["rows"].push_back({{"job", row.job},
                            {"subject", row.subject},
                            {"exit", row.exit_code},
                            {"words", row.words},
                            {"rate_s_per_day", json_number(row.rate_s_per_day)},
                            {"sigma", json_number(row.sigma)}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace goingrate

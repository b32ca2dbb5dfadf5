// The fitted parameters as tables for other programs.
#include "goingrate/report/tables.hpp"

#include "rounded.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace goingrate {

namespace {

// The number in LaTeX's math mode.
std::string in_mathematics(const Rounded& number, std::string_view sign = "") {
  std::string text = std::string(sign) + number.value;
  if (!number.sigma.empty()) text += " \\pm " + number.sigma;
  if (number.power == 0) return "$" + text + "$";
  if (!number.sigma.empty()) text = "(" + text + ")";
  return fmt::format("${} \\times 10^{{{}}}$", text, number.power);
}

std::string in_mathematics(double value, int digits, std::string_view sign = "") {
  return in_mathematics(rounded(value, 0.0, digits), sign);
}

std::string symbol(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> symbols{
      {{"T0", "$T_0$"},
       {"epsilon", "$\\varepsilon$"},
       {"mu", "$\\mu$"},
       {"phi0", "$\\varphi_0$"},
       {"lambda0", "$\\lambda_0$"}}};
  const std::size_t at = name.find('@');
  const std::string base = name.substr(0, at);
  std::string text;
  for (const auto& [word, sign] : symbols)
    if (base == word) text = sign;
  if (text.empty())
    for (const char c : base)
      text += c == '_' ? std::string("\\_") : std::string(1, c);
  return at == name.npos ? text : fmt::format("{} at event {}", text, name.substr(at + 1));
}

std::string latex_value(const FittedParameter& p) {
  if (p.status == ParameterStatus::undetermined) return "undetermined";
  if (p.status == ParameterStatus::fixed) return in_mathematics(p.value, 10) + " (fixed)";
  return in_mathematics(rounded(p.value, p.sigma, 6));
}

std::string latex_interval(const FittedParameter& p) {
  if (!std::isfinite(p.sigma) || !is_lopsided(p)) return "";
  const auto end = [&](double at) {
    return std::isfinite(at) ? in_mathematics(at - p.value, 2, at < p.value ? "" : "+")
                             : std::string("open");
  };
  return fmt::format("{} to {}", end(p.low95), end(p.high95));
}

std::string csv_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.17g}", value) : std::string();
}

} // namespace

std::string_view name_of(ParameterStatus status) {
  switch (status) {
  case ParameterStatus::fixed:
    return "fixed";
  case ParameterStatus::prior:
    return "prior";
  case ParameterStatus::undetermined:
    return "undetermined";
  case ParameterStatus::free:
    break;
  }
  return "free";
}

bool is_lopsided(const FittedParameter& parameter) {
  const double down = parameter.value - parameter.low95, up = parameter.high95 - parameter.value;
  return !(std::abs(up - down) < 0.1 * (up + down)); // by more than a tenth
}

std::string fit_latex(const FitSummary& fit) {
  std::string text =
      "% needs \\usepackage{booktabs}\n"
      "\\begin{tabular}{llll}\n\\toprule\n"
      "Parameter & Value & Unit & 95\\,\\% interval about the value \\\\\n\\midrule\n";
  for (const FittedParameter& p : fit.parameters)
    text += fmt::format("{} & {} & {} & {} \\\\\n", symbol(p.name), latex_value(p), p.unit,
                        latex_interval(p));
  return text + "\\bottomrule\n\\end{tabular}\n";
}

std::string fit_csv(const FitSummary& fit) {
  std::string text = "name,value,sigma,low68,high68,low95,high95,unit,status\n";
  for (const FittedParameter& p : fit.parameters) {
    text += p.name;
    for (const double value : {p.value, p.sigma, p.low68, p.high68, p.low95, p.high95})
      text.append(",").append(csv_number(value));
    text += fmt::format(",{},{}\n", p.unit, name_of(p.status));
  }
  return text;
}

std::string drive_table(const DriveHistory& history) {
  std::string text = "time_s,relative_drive,sigma\n";
  for (const DrivePoint& point : history.points)
    text += fmt::format("{:.6f},{:.6g},{:.3g}\n", point.at_s, point.relative, point.sigma);
  return text;
}

} // namespace goingrate

// Figures of the fitted parameters: their profiles, correlations and intervals.
#include "base/special_values.hpp"
#include "palette.hpp"
#include "parameter_words.hpp"
#include "report_figures.hpp"

#include "goingrate/fit/clock_fit.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace goingrate {

namespace {

bool is_determined(const FitSummary& fit, const std::string& name) {
  const FittedParameter* found = fit.find(name);
  return !found || found->status != ParameterStatus::undetermined;
}

bool has_intervals(const FittedParameter& p) {
  return (p.status == ParameterStatus::free || p.status == ParameterStatus::prior) &&
         std::isfinite(p.value) && p.sigma > 0.0 && p.low68 < p.high68;
}

// A curve through the computed points. Between two of them the signed root of the fall is
// interpolated linearly, so that a parabola is drawn as one.
Series profile_curve(const FittedParameter& p, int colour) {
  constexpr int steps = 8; // between two points
  Series curve{Series::Style::line, label_of(p.name), {}, {}, {}, {}, colour};
  const auto root_of = [&](const ProfilePoint& point) {
    return std::copysign(std::sqrt(point.fall), point.value - p.value);
  };
  for (std::size_t i = 1; i < p.profile.size(); ++i)
    for (int k = i == 1 ? 0 : 1; k <= steps; ++k) {
      const ProfilePoint &from = p.profile[i - 1], &to = p.profile[i];
      const double part = static_cast<double>(k) / steps;
      curve.x.push_back((std::lerp(from.value, to.value, part) - p.value) / p.sigma);
      curve.y.push_back(std::pow(std::lerp(root_of(from), root_of(to), part), 2));
    }
  return curve;
}

} // namespace

std::optional<Figure> profile_figure(const FitSummary& fit) {
  Figure figure{
      "profiles",
      "Profile likelihoods",
      "How far 2 log L falls when a parameter is held away from its best value and all others are "
      "fitted again, at up to five places on either side: by 1 at the ends of the 68 % interval, "
      "by 3.84 at those of 95 %. A lopsided curve means a larger error on one side; where a curve "
      "stays low the interval has no end.",
      {"distance from the best value", "σ"},
      {"fall of 2 log L", ""},
      {}};
  constexpr std::size_t colours = 8; // then shifted by one, so that each recurs with another dash
  for (const FittedParameter& p : fit.parameters) {
    const std::size_t i = figure.series.size();
    if (!p.profile.empty())
      figure.series.push_back(profile_curve(p, static_cast<int>((i + i / colours) % colours)));
  }
  std::erase_if(figure.series, [](const Series& series) { return series.x.empty(); });
  if (figure.series.empty()) return std::nullopt;
  return figure;
}

std::optional<Figure> correlation_figure(const FitSummary& fit) {
  std::vector<std::size_t> shown; // the determined ones: the others' correlations are the priors'
  for (std::size_t i = 0; i < std::min(fit.correlated.size(), fit.correlation.size()); ++i)
    if (is_determined(fit, fit.correlated[i])) shown.push_back(i);
  if (shown.size() < 2) return std::nullopt;
  Figure figure{"correlation",
                "Correlation of the fitted parameters",
                "Blue: an error that makes one of the two too large makes the other too large as "
                "well; vermilion: too small. Near ±1 the log knows the two together much better "
                "than each alone. The numbers along the foot are those after the names.",
                {"", ""},
                {"", ""},
                {{Series::Style::cells, "correlation", {}, {}, {}, {}, blue}}};
  const std::size_t count = shown.size();
  Series& cells = figure.series.front();
  for (std::size_t i = 0; i < count; ++i) {
    figure.x.names.push_back(fmt::format("{}", i + 1));
    const std::size_t from_foot = count - 1 - i; // the first row is on top, as in a matrix
    figure.y.names.push_back(
        fmt::format("{} {}", label_of(fit.correlated[shown[from_foot]]), from_foot + 1));
    for (std::size_t k = 0; k < count; ++k) {
      const auto& row = fit.correlation[shown[i]];
      cells.x.push_back(static_cast<double>(k));
      cells.y.push_back(static_cast<double>(from_foot));
      cells.low.push_back(shown[k] < row.size() ? row[shown[k]] : not_known);
    }
  }
  return figure;
}

std::optional<Figure> interval_figure(const FitSummary& fit) {
  constexpr double edge_sigmas =
      5.0; // sigma: bars are cut here; ends are searched for up to 30 (profile.hpp)
  Series narrow{Series::Style::bars, "68 %", {}, {}, {}, {}, blue};
  Series wide{Series::Style::bars, "95 %", {}, {}, {}, {}, vermilion};
  Figure figure{"intervals",
                "Intervals of the parameters",
                "Where the profile likelihood puts each parameter, in units of its σ from the best "
                "value: about ±1 (68 %) and ±2 (95 %) where it is a parabola. A lopsided bar means "
                "that the error is larger on that side; one that runs to 5 ends beyond or never.",
                {"", ""},
                {"distance from the best value", "σ"},
                {}};
  const auto add = [&](Series& series, double at, const FittedParameter& p, double low,
                       double high) {
    series.x.push_back(at);
    series.y.push_back(0.0);
    series.low.push_back(std::clamp((low - p.value) / p.sigma, -edge_sigmas, edge_sigmas));
    series.high.push_back(std::clamp((high - p.value) / p.sigma, -edge_sigmas, edge_sigmas));
  };
  for (const FittedParameter& p : fit.parameters) {
    if (!has_intervals(p)) continue;
    const auto at = static_cast<double>(figure.x.names.size());
    constexpr double side_step = 0.08; // places: both bars can be seen
    add(narrow, at - side_step, p, p.low68, p.high68);
    if (p.low95 < p.high95) add(wide, at + side_step, p, p.low95, p.high95);
    figure.x.names.push_back(label_of(p.name));
  }
  if (figure.x.names.empty()) return std::nullopt;
  figure.series = {std::move(narrow), std::move(wide)};
  return figure;
}

} // namespace goingrate

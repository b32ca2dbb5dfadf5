#include "page_data.hpp"

#include "figure_axes.hpp"
#include "json_parts.hpp"
#include "packed.hpp"

#include <algorithm>

namespace goingrate {

namespace {

constexpr std::size_t budget = 800'000;     // numbers: two megabytes as text
constexpr std::size_t line_length = 20'000; // values that a wide screen can show at a zoom of five
constexpr std::size_t longest_list = 1000;  // values; a longer array is packed

const char* name_of(Series::Style style) {
  switch (style) {
  case Series::Style::line:
    return "line";
  case Series::Style::points:
    return "points";
  case Series::Style::band:
    return "band";
  case Series::Style::bars:
    return "bars";
  case Series::Style::cells:
    break;
  }
  return "cells";
}

// The arrays of a page, each stored once.
class Arrays {
public:
  std::size_t add(std::vector<double> values) {
    for (std::size_t i = 0; i < kept_.size(); ++i)
      if (kept_[i] == values) return i; // an array with NaN equals no other, which only costs space
    if (values.size() <= longest_list)
      json_.push_back(values);
    else
      json_.push_back({{"count", values.size()}, {"packed", packed(values)}});
    kept_.push_back(std::move(values));
    return kept_.size() - 1;
  }
  [[nodiscard]] const Json& json() const { return json_; }

private:
  std::vector<std::vector<double>> kept_;
  Json json_ = Json::array();
};

std::size_t wanted(const Series& series) {
  const std::size_t size = series.x.size();
  return series.style == Series::Style::points ? size : std::min(size, line_length);
}

// The most values that each series may have so that all series fit into the budget.
std::size_t longest_series(const std::vector<Figure>& figures) {
  std::vector<std::size_t> sizes;
  for (const Figure& figure : figures)
    for (const Series& series : figure.series)
      sizes.push_back(wanted(series));
  std::sort(sizes.begin(), sizes.end());
  std::size_t left = budget / 2; // x values take about as much as y values
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const std::size_t share = left / (sizes.size() - i);
    if (sizes[i] > share) return share;
    left -= sizes[i];
  }
  return budget;
}

// Only the outline of a band matters: both ends of a stretch get its widest limits.
std::vector<double> outline(const std::vector<double>& values, std::size_t stretch, bool highest) {
  std::vector<double> result = extremes(values, stretch);
  for (std::size_t i = 0; i + 1 < result.size(); i += 2)
    result[i] = result[i + 1] =
        highest ? std::max(result[i], result[i + 1]) : std::min(result[i], result[i + 1]);
  return result;
}

Json series_json(const Series& series, std::size_t longest, Arrays& arrays) {
  longest = std::min(longest, wanted(series));
  const bool thin = series.x.size() > longest;
  const std::size_t stretch = thin ? (2 * series.x.size() + longest - 1) / longest : 1;
  Json json{{"style", name_of(series.style)},
            {"label", series.label},
            {"colour", series.colour},
            {"stretch", stretch},
            {"x", arrays.add(thin ? quarters(series.x, stretch) : series.x)}};
  if (!series.y.empty()) json["y"] = arrays.add(thin ? extremes(series.y, stretch) : series.y);
  if (series.low.empty()) return json;
  json["low"] = arrays.add(thin ? outline(series.low, stretch, false) : series.low);
  if (!series.high.empty())
    json["high"] = arrays.add(thin ? outline(series.high, stretch, true) : series.high);
  return json;
}

Json axis_json(const Axis& axis) {
  return {{"title", axis.unit.empty() ? axis.label : axis.label + " (" + axis.unit + ")"},
          {"unit", axis.unit},
          {"logarithmic", axis.logarithmic},
          {"names", axis.names}};
}

Json panel_json(const Figure& figure, std::size_t longest, Arrays& arrays) {
  Json panel{{"title", figure.title},
             {"x", axis_json(figure.x)},
             {"y", axis_json(figure.y)},
             {"markers", Json::array()},
             {"series", Json::array()}};
  if (const FigureAxes axes = figure_axes(figure); axes.clipped)
    panel["bulk"] = {axes.y.from, axes.y.to};
  for (const Marker& marker : figure.markers)
    panel["markers"].push_back({{"x", marker.x}, {"label", marker.label}});
  for (const Series& series : figure.series)
    panel["series"].push_back(series_json(series, longest, arrays));
  return panel;
}

} // namespace

std::vector<std::size_t> plot_begins(const std::vector<Figure>& figures) {
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < figures.size(); ++i)
    if (i == 0 || figures[i].group.empty() || figures[i].group != figures[i - 1].group)
      begins.push_back(i);
  begins.push_back(figures.size());
  return begins;
}

std::string page_data(const std::vector<Figure>& figures) {
  Arrays arrays;
  Json plots = Json::array();
  const std::size_t longest = longest_series(figures);
  const std::vector<std::size_t> begins = plot_begins(figures);
  for (std::size_t p = 0; p + 1 < begins.size(); ++p) {
    Json panels = Json::array();
    for (std::size_t i = begins[p]; i < begins[p + 1]; ++i)
      panels.push_back(panel_json(figures[i], longest, arrays));
    plots.push_back({{"panels", panels}});
  }
  const std::string text = Json{{"arrays", arrays.json()}, {"plots", plots}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
  return safe_in_script(text);
}

} // namespace goingrate

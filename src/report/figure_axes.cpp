#include "figure_axes.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace goingrate {

namespace {

constexpr std::array<std::string_view, 8> okabe_ito{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                    "#E69F00", "#56B4E9", "#F0E442", "#000000"};
constexpr int line_kinds = 4; // dashes
constexpr int mark_kinds = 3;

void check(const Series& series) {
  const bool ranged = series.style == Series::Style::band || series.style == Series::Style::bars;
  const bool plain = series.style != Series::Style::band;
  if ((plain && series.y.size() != series.x.size()) ||
      (ranged && (series.low.size() != series.x.size() || series.high.size() != series.x.size())) ||
      (series.style == Series::Style::cells && series.low.size() != series.x.size()))
    throw ArgumentError("series", series.label, "vectors of one length");
}

struct Interval {
  double low = 0.0, high = 0.0;
};

// The smallest and largest value that can be shown.
class Range {
public:
  explicit Range(bool logarithmic) : logarithmic_(logarithmic) {}
  void include(double value) {
    if (!can_be_shown(value, logarithmic_)) return;
    lowest_ = std::min(lowest_, value);
    highest_ = std::max(highest_, value);
  }
  [[nodiscard]] AxisScale scale(const Axis& axis, double margin) const {
    return lowest_ <= highest_ ? scale_axis(axis, lowest_, highest_, margin) : empty_axis(axis);
  }
  [[nodiscard]] bool empty() const { return lowest_ > highest_; }

private:
  bool logarithmic_;
  double lowest_ = std::numeric_limits<double>::infinity();
  double highest_ = -std::numeric_limits<double>::infinity();
};

bool sets_bulk(const Series& series) {
  return series.style == Series::Style::points || series.style == Series::Style::line;
}

// Whether the y axis is set by the bulk of the values.
bool is_of_bulk(const Figure& figure) {
  return !figure.y.logarithmic && figure.y.names.empty() &&
         std::any_of(figure.series.begin(), figure.series.end(),
                     [](const Series& series) { return series.style == Series::Style::points; });
}

// The range of the values, without those far outside the middle 98 % (of a line 94 %), as in a box
// plot; if there are few values, unlimited.
Interval bulk_of(const Series& series) {
  std::vector<double> values;
  for (const double value : series.y)
    if (can_be_shown(value, false)) values.push_back(value);
  constexpr std::size_t least_count = 20;
  constexpr Interval all{-std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::infinity()};
  if (values.size() < least_count) return all;
  // A running mean carries one bad value through a window of a hundredth of the series.
  const std::size_t hundredths = series.style == Series::Style::line ? 3 : 1;
  const std::size_t left_out = std::max<std::size_t>(1, hundredths * values.size() / 100);
  const auto at = [&](std::size_t place) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  const double low = at(left_out), high = at(values.size() - 1 - left_out);
  const double span = high - low;
  return span > 0.0 ? Interval{low - span, high + span} : all;
}

void include(const Figure& figure, Range& x, Range& y, bool& clipped) {
  for (const Series& series : figure.series) {
    check(series);
    const bool by_bulk = is_of_bulk(figure) && sets_bulk(series);
    const Interval bulk = by_bulk ? bulk_of(series) : Interval{};
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!can_be_shown(series.x[i], figure.x.logarithmic)) continue;
      const bool band = series.style == Series::Style::band;
      const double value = band ? 0.5 * (series.low[i] + series.high[i]) : series.y[i];
      if (!can_be_shown(value, figure.y.logarithmic)) continue;
      x.include(series.x[i]);
      if (by_bulk && (value < bulk.low || value > bulk.high)) {
        clipped = true;
        continue;
      }
      y.include(value);
      if (band || series.style == Series::Style::bars) {
        y.include(series.low[i]);
        y.include(series.high[i]);
      }
    }
  }
}

} // namespace

FigureAxes figure_axes(const Figure& figure, const std::vector<Figure>& beside) {
  Range x(figure.x.logarithmic);
  Range y(figure.y.logarithmic);
  FigureAxes axes;
  include(figure, x, y, axes.clipped);
  axes.empty = x.empty();
  for (const Figure& other : beside) {
    Range unused(other.y.logarithmic);
    bool also_unused = false;
    include(other, x, unused, also_unused);
  }
  constexpr double side_margin = 0.01; // room so that dots at the edge are not cut
  constexpr double top_margin = 0.05;
  axes.x = x.scale(figure.x, side_margin);
  axes.y = y.scale(figure.y, top_margin);
  return axes;
}

SeriesWithin within(const Series& series, const FigureAxes& axes) {
  SeriesWithin result{series, {}};
  if (!axes.clipped || !sets_bulk(series)) return result;
  constexpr double marks = 150.0; // most marks along the axis
  std::array<double, 2> last{-1.0, -1.0};
  for (std::size_t i = 0; i < series.y.size(); ++i) {
    double& value = result.inside.y[i];
    if (!can_be_shown(value, false) || (value >= axes.y.from && value <= axes.y.to)) continue;
    const bool above = value > axes.y.to;
    if (series.style == Series::Style::line) {
      value = above ? axes.y.to : axes.y.from;
      continue;
    }
    value = std::numeric_limits<double>::quiet_NaN();
    const double place = std::floor(marks * axes.x.place(series.x[i]));
    if (std::isnan(place) || place == last.at(above ? 1 : 0)) continue;
    last.at(above ? 1 : 0) = place;
    result.beyond.push_back({series.x[i], above});
  }
  return result;
}

std::vector<Look> series_looks(const Figure& figure) {
  constexpr std::size_t most_large_dots = 160; // dots that have room to be large
  std::vector<Look> looks;
  int lines = 0;
  int marks = 0;
  for (const Series& series : figure.series) {
    const int colour = series.colour < 0 ? 0 : series.colour % static_cast<int>(okabe_ito.size());
    Look look{colour, 0, series.x.size() > most_large_dots};
    if (series.style == Series::Style::line)
      look.kind = lines++ % line_kinds;
    else if (series.style != Series::Style::band)
      look.kind = marks++ % mark_kinds;
    looks.push_back(look);
  }
  return looks;
}

double half_of_last_label(const AxisScale& x) {
  double reach = 0.0;
  for (const AxisTick& tick : x.ticks)
    if (tick.place > 0.85) reach = 0.5 * static_cast<double>(characters(tick.label));
  return reach;
}

std::vector<PlacedMarker> place_markers(const Figure& figure, const FigureAxes& axes,
                                        double character, double apart) {
  constexpr std::size_t most_rows = 4;
  std::vector<PlacedMarker> placed;
  if (axes.empty) return placed;
  std::vector<double> row_ends;
  for (const Marker& marker : figure.markers) {
    const double place = axes.x.place(marker.x);
    if (!(place >= 0.0 && place <= 1.0)) continue;
    const double half = 0.5 * (character * static_cast<double>(characters(marker.label)) + apart);
    const double centre = std::clamp(place, half, std::max(half, 1.0 - half));
    std::size_t row = 0;
    while (row < row_ends.size() && row_ends[row] > centre - half)
      ++row;
    row %= most_rows;
    row_ends.resize(std::max(row_ends.size(), row + 1));
    row_ends[row] = centre + half;
    placed.push_back({&marker, centre, row});
  }
  return placed;
}

std::size_t rows_of(const std::vector<PlacedMarker>& markers) {
  std::size_t rows = 0;
  for (const PlacedMarker& placed : markers)
    rows = std::max(rows, placed.row + 1);
  return rows;
}

std::string_view palette(int colour) { return okabe_ito.at(static_cast<std::size_t>(colour)); }

std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

} // namespace goingrate

#include "gnuplot_series.hpp"

#include "markup.hpp"
#include "series_thinning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <iterator>

namespace goingrate::gnuplot {

namespace {

// The drawing for which series are thinned: as wide, in dots, as a plot of 7 cm at 300 dots per
// inch. Its y grows downwards and is a place on the axis.
constexpr double columns = 800.0;

double column_place(const AxisScale& x, double value) { return columns * x.place(value); }

// Writes the data and the plot command of one series.
class Writer {
public:
  Writer(const Series& series, const Look& look, const FigureAxes& axes,
         const CurveOptions& options)
      : within_(within(series, axes)), series_(within_.inside), look_(look), axes_(axes),
        options_(options) {}

  Curves curves() {
    switch (series_.style) {
    case Series::Style::line:
      add_line();
      break;
    case Series::Style::band:
      add_band();
      break;
    case Series::Style::bars:
      add_bars();
      break;
    case Series::Style::cells:
      add_cells();
      break;
    case Series::Style::points:
      look_.dense ? add_cloud() : add_marks(series_.x, series_.y);
      add_rim();
      break;
    }
    return std::move(curves_);
  }

private:
  void add_line();
  void add_band();
  void add_bars();
  void add_cells();
  void add_cloud();
  void add_rim();
  void add_marks(const std::vector<double>& x, const std::vector<double>& y);
  void add_strokes(const std::vector<Extent>& strokes);

  [[nodiscard]] std::vector<Place> places() const {
    std::vector<Place> result;
    for (std::size_t i = 0; i < series_.x.size(); ++i)
      result.push_back({column_place(axes_.x, series_.x[i]), -axes_.y.place(series_.y[i])});
    return result;
  }
  [[nodiscard]] std::string x_of(double column) const {
    return number(value_at(axes_.x, column / columns));
  }
  [[nodiscard]] std::string y_of(double down) const { return number(value_at(axes_.y, -down)); }
  [[nodiscard]] std::string colour() const {
    return fmt::format("linecolor rgb '{}'", palette(look_.colour));
  }

  // Adds a block of data and the command that draws it; does nothing without data.
  void add(const std::string& data, std::string_view manner, bool titled) {
    if (data.empty()) return;
    const std::string name = fmt::format("{}{}", options_.name, blocks_++);
    curves_.data += fmt::format("{} << EOD\n{}EOD\n", name, data);
    add_plot(name, manner, titled);
  }
  void add_plot(const std::string& source, std::string_view manner, bool titled) {
    if (!curves_.plots.empty()) curves_.plots += ", \\\n     ";
    curves_.plots +=
        fmt::format("{} {} {}", source, manner,
                    titled && options_.titled ? "title " + gnuplot::quoted(series_.label)
                                              : std::string("notitle"));
  }

  const SeriesWithin within_;
  const Series& series_; // inside the axes
  const Look& look_;
  const FigureAxes& axes_;
  const CurveOptions& options_;
  Curves curves_;
  char blocks_ = 'a';
};

void Writer::add_line() {
  static constexpr std::array<const char*, 4> dashes{"1", "(12,6)", "(3,4)", "(12,4,3,4)"};
  std::string data;
  for (const auto& run : thinned_line(places())) {
    for (const Place& place : run)
      data += x_of(place.x) + ' ' + y_of(place.y) + '\n';
    if (run.size() == 1) data += x_of(run[0].x) + ' ' + y_of(run[0].y) + '\n'; // a dot
    data += '\n';
  }
  add(data,
      fmt::format("with lines linewidth 1.4 dashtype {} {}",
                  dashes.at(static_cast<std::size_t>(look_.kind)), colour()),
      true);
}

void Writer::add_band() {
  std::vector<Extent> extents;
  for (std::size_t i = 0; i < series_.x.size(); ++i)
    extents.push_back({column_place(axes_.x, series_.x[i]), -axes_.y.place(series_.low[i]),
                       -axes_.y.place(series_.high[i])});
  std::string data;
  for (const auto& run : thinned_band(extents)) {
    for (const Extent& extent : run)
      data += x_of(extent.x) + ' ' + y_of(extent.low) + ' ' + y_of(extent.high) + '\n';
    data += '\n';
  }
  add(data,
      fmt::format("using 1:2:3 with filledcurves fillstyle transparent solid 0.3 noborder {}",
                  colour()),
      true);
}

void Writer::add_marks(const std::vector<double>& x, const std::vector<double>& y) {
  static constexpr std::array<int, 3> marks{7, 5, 13}; // a disc, a square, a diamond
  std::string data;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!std::isnan(axes_.x.place(x[i])) && !std::isnan(axes_.y.place(y[i])))
      data += number(x[i]) + ' ' + number(y[i]) + '\n';
  add(data,
      fmt::format("with points pointtype {} pointsize {} {}",
                  marks.at(static_cast<std::size_t>(look_.kind)), look_.kind == 2 ? 0.5 : 0.35,
                  colour()),
      true);
}

void Writer::add_bars() {
  std::string data;
  for (std::size_t i = 0; i < series_.x.size(); ++i) {
    // A bar that reaches below the range of a logarithmic axis ends at the foot of the axis.
    const bool no_foot = axes_.y.logarithmic && series_.low[i] <= 0.0;
    const double low = no_foot ? value_at(axes_.y, 0.0) : series_.low[i];
    if (std::isnan(axes_.x.place(series_.x[i])) || std::isnan(axes_.y.place(series_.y[i])) ||
        std::isnan(axes_.y.place(low)) || std::isnan(axes_.y.place(series_.high[i])))
      continue;
    data += fmt::format("{} {} {}\n", number(series_.x[i]), number(low), number(series_.high[i]));
  }
  add(data,
      fmt::format(
          "using 1:2:(0):($3-$2) with vectors heads size screen 0.006,90 nofilled linewidth 0.9 {}",
          colour()),
      false);
  add_marks(series_.x, series_.y);
}

// A square with its number: blue above zero, vermilion below, stronger the farther from zero.
void Writer::add_cells() {
  constexpr double fullest_share = 0.8;
  std::string squares, words;
  for (std::size_t i = 0; i < series_.x.size(); ++i) {
    const double value = series_.low[i];
    if (!std::isfinite(value)) continue;
    const double part = fullest_share * std::min(1.0, std::abs(value));
    const long ink = std::strtol(palette(value < 0.0 ? 1 : 0).data() + 1, nullptr, 16);
    long mixed = 0;
    for (const int shift : {16, 8, 0})
      mixed |= std::lround(255.0 + part * (static_cast<double>((ink >> shift) & 255) - 255.0))
               << shift;
    squares += fmt::format("{} {} {}\n", number(series_.x[i]), number(series_.y[i]), mixed);
    words += fmt::format("{} {} {}\n", number(series_.x[i]), number(series_.y[i]),
                         typeset(fmt::format("{:.2f}", std::abs(value) < 0.005 ? 0.0 : value)));
  }
  add(squares,
      "using 1:2:($1-0.5):($1+0.5):($2-0.5):($2+0.5):3 with boxxyerror fillstyle solid 1 noborder "
      "linecolor rgb variable",
      false);
  const double span = axes_.x.to - axes_.x.from; // as many squares
  add(words, fmt::format("using 1:2:3 with labels font 'sans,{:.1f}'", std::min(8.0, 50.0 / span)),
      false);
}

void Writer::add_strokes(const std::vector<Extent>& strokes) {
  std::string data;
  for (const Extent& stroke : strokes)
    data += x_of(stroke.x) + ' ' + y_of(stroke.low) + '\n' + x_of(stroke.x) + ' ' +
            y_of(stroke.high) + "\n\n";
  const std::string pale = "#80" + std::string(palette(look_.colour).substr(1));
  add(data, fmt::format("with lines linewidth 0.5 linecolor rgb '{}'", pale), false);
}

void Writer::add_cloud() {
  const Cloud cloud = thinned_cloud(places());
  add_strokes(cloud.body);
  std::string data;
  for (const Place& dot : cloud.dots)
    data += x_of(dot.x) + ' ' + y_of(dot.y) + '\n';
  const double size = cloud.body.empty() ? 0.2 : 0.1; // dots alone must be larger
  add(data, fmt::format("with points pointtype 7 pointsize {} {}", size, colour()), false);
  // The dots themselves would be too small in the key.
  if (options_.titled) add_plot("NaN", "with points pointtype 7 pointsize 0.3 " + colour(), true);
}

// Triangles that point towards the values beyond the axis.
void Writer::add_rim() {
  for (const bool above : {false, true}) {
    std::string data;
    for (const RimMark& mark : within_.beyond)
      if (mark.above == above)
        data += number(mark.x) + ' ' + number(value_at(axes_.y, above ? 0.98 : 0.02)) + '\n';
    if (!data.empty())
      add(data, fmt::format("with points pointtype {} pointsize 0.5 {}", above ? 9 : 11, colour()),
          false);
  }
}

} // namespace

double value_at(const AxisScale& scale, double place) {
  const double at = scale.from + place * (scale.to - scale.from);
  return scale.logarithmic ? std::pow(10.0, at) : at;
}

std::string number(double value) { return fmt::format("{:.12g}", value); }

std::string quoted(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'')
      result += "’"; // doubled it would be one as well, but not at the beginning of a tick's label
    else
      result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return result + "'";
}

std::string commented(std::string_view text) {
  std::string result(text);
  std::replace_if(
      result.begin(), result.end(),
      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\\'; }, ' ');
  return result;
}

Curves curves(const Series& series, const Look& look, const FigureAxes& axes,
              const CurveOptions& options) {
  return Writer(series, look, axes, options).curves();
}

} // namespace goingrate::gnuplot

#include "goingrate/report/figure.hpp"

#include "figure_axes.hpp"
#include "figure_cells.hpp"
#include "markup.hpp"
#include "series_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <optional>

namespace goingrate {

namespace {

// Sizes of the drawing, in its own units. Text is 13 units high, or 20 on a telephone, for which
// the margins have room.
constexpr double width = 720.0;
constexpr double plot_height = 320.0;
constexpr double least_left = 80.0;
constexpr double least_right = 14.0;
constexpr double space_above = 14.0;
constexpr double space_below = 58.0;
constexpr double legend_row = 26.0;
constexpr double marker_row = 21.0;
constexpr double character = 11.0; // width of a character, generously

std::string identifier(const std::string& id) {
  std::string out = "figure-";
  for (const char c : id) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    out += plain ? c : '-';
  }
  return out;
}

struct LegendEntry {
  double x = 0.0;
  double y = 0.0;
};

class Drawing {
public:
  explicit Drawing(const Figure& figure)
      : figure_(figure), id_(identifier(figure.id)), looks_(series_looks(figure)) {
    const FigureAxes axes = figure_axes(figure);
    x_ = axes.x;
    y_ = axes.y;
    empty_ = axes.empty;
    for (const Series& series : figure.series)
      series_.push_back(within(series, axes));
    std::size_t longest = 0;
    for (const AxisTick& tick : y_.ticks)
      longest = std::max(longest, characters(tick.label));
    left_ = std::max(least_left, 28.0 + character * static_cast<double>(longest)); // 28: the title
    right_ = width - std::max(least_right, 6.0 + character * half_of_last_label(x_));
    markers_ = place_markers(figure, axes, character / (right_ - left_), 6.0 / (right_ - left_));
    lay_out_legend();
  }

  [[nodiscard]] double height() const { return bottom_ + space_below; }

  // The SVG. With a style it is a complete file; `top` is the figure's place in a stack.
  std::string text(bool with_style, std::optional<double> top = {}) {
    open(with_style, top);
    draw_grid();
    draw_markers();
    for (std::size_t i = 0; i < figure_.series.size(); ++i)
      draw_series(i);
    draw_frame();
    draw_legend();
    text_ += "</svg>\n";
    return std::move(text_);
  }

private:
  void lay_out_legend();
  void open(bool with_style, std::optional<double> top);
  void draw_grid();
  void draw_markers();
  void draw_series(std::size_t index);
  void draw_marks(const Series& series, const Look& look);
  void draw_rim(const std::vector<RimMark>& marks, const Look& look);
  void draw_frame();
  void draw_legend();
  void draw_sample(const Series& series, const Look& look, const LegendEntry& at);
  void mark(int kind, double x, double y, std::string& path) const;
  [[nodiscard]] std::vector<Place> places(const Series& series) const;
  [[nodiscard]] std::vector<Extent> extents(const Series& series) const;
  [[nodiscard]] std::vector<Cell> cells(const Series& series) const;
  [[nodiscard]] double across(double x) const { return left_ + (right_ - left_) * x_.place(x); }
  [[nodiscard]] double down(double y) const { return bottom_ - plot_height * y_.place(y); }

  template <class... Arguments>
  void write(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  const Figure& figure_;
  std::string id_;
  std::string text_;
  AxisScale x_, y_;
  bool empty_ = false;
  double left_ = least_left;
  double right_ = width - least_right;
  double top_ = space_above;
  double bottom_ = 0.0;
  std::vector<LegendEntry> legend_;
  std::vector<Look> looks_;
  std::vector<SeriesWithin> series_; // as they are drawn
  std::vector<PlacedMarker> markers_;
};

void Drawing::lay_out_legend() {
  constexpr double sample = 36.0;
  constexpr double spacing = 20.0;
  double x = left_;
  double y = space_above + 8.0;
  if (figure_.series.size() > 1) {
    for (const Series& series : figure_.series) {
      const double needed = sample + character * static_cast<double>(characters(series.label));
      if (x > left_ && x + needed > right_) {
        x = left_;
        y += legend_row;
      }
      legend_.push_back({x, y});
      x += needed + spacing;
    }
    top_ = y + legend_row - 6.0;
  }
  top_ += marker_row * static_cast<double>(rows_of(markers_));
  bottom_ = top_ + plot_height;
}

void Drawing::open(bool with_style, std::optional<double> top) {
  // In a stack, the outermost element has the class, and thereby the style.
  const std::string place =
      top ? fmt::format("y=\"{}\" width=\"{}\" height=\"{}\"", coordinate(*top), coordinate(width),
                        coordinate(height()))
          : std::string("class=\"figure\"");
  write("<svg xmlns=\"http://www.w3.org/2000/svg\" {3} id=\"{0}\" "
        "viewBox=\"0 0 {1} {2}\" role=\"img\" aria-labelledby=\"{0}-title {0}-description\">\n",
        id_, coordinate(width), coordinate(height()), place);
  write("<title id=\"{0}-title\">{1}</title>\n<desc id=\"{0}-description\">{2}</desc>\n", id_,
        escape_markup(figure_.title), escape_markup(figure_.caption));
  if (with_style) write("<style>{}</style>\n", figure_style());
}

void Drawing::draw_grid() {
  std::string lines;
  std::string minor;
  std::string labels;
  const auto out = std::back_inserter(labels);
  bool lower = false; // every second name is put lower, so that long names have room
  for (const AxisTick& tick : x_.ticks) {
    const std::string x = coordinate(left_ + (right_ - left_) * tick.place);
    (tick.label.empty() ? minor : lines) +=
        fmt::format("M{} {}V{}", x, coordinate(top_), coordinate(bottom_));
    if (tick.label.empty()) continue;
    fmt::format_to(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", x,
                   coordinate(bottom_ + (lower ? 41.0 : 21.0)), escape_markup(tick.label));
    lower = !lower && figure_.x.names.size() > 4;
  }
  for (const AxisTick& tick : y_.ticks) {
    const double y = bottom_ - plot_height * tick.place;
    (tick.label.empty() ? minor : lines) +=
        fmt::format("M{} {}H{}", coordinate(left_), coordinate(y), coordinate(right_));
    if (tick.label.empty()) continue;
    fmt::format_to(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" dy=\".35em\">{}</text>\n",
                   coordinate(left_ - 7.0), coordinate(y), escape_markup(tick.label));
  }
  if (!minor.empty()) write("<path class=\"minor\" d=\"{}\"/>\n", minor);
  if (!lines.empty()) write("<path class=\"grid\" d=\"{}\"/>\n", lines);
  if (!labels.empty()) write("<g class=\"ticks\">\n{}</g>\n", labels);
}

void Drawing::draw_markers() {
  for (const PlacedMarker& placed : markers_) {
    const double foot = top_ - 7.0 - marker_row * static_cast<double>(placed.row);
    write("<path class=\"marker\" d=\"M{} {}V{}\"/>\n", coordinate(across(placed.marker->x)),
          coordinate(top_), coordinate(bottom_));
    write("<text class=\"note\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
          coordinate(left_ + (right_ - left_) * placed.centre), coordinate(foot),
          escape_markup(placed.marker->label));
  }
}

std::vector<Place> Drawing::places(const Series& series) const {
  std::vector<Place> result;
  result.reserve(series.x.size());
  for (std::size_t i = 0; i < series.x.size(); ++i)
    result.push_back({across(series.x[i]), down(series.y[i])});
  return result;
}

std::vector<Cell> Drawing::cells(const Series& series) const {
  std::vector<Cell> result;
  for (std::size_t i = 0; i < series.x.size(); ++i)
    result.push_back({across(series.x[i] - 0.5), down(series.y[i] + 0.5), across(1.0) - across(0.0),
                      down(0.0) - down(1.0), series.low[i]});
  return result;
}

std::vector<Extent> Drawing::extents(const Series& series) const {
  std::vector<Extent> result;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    // A bar that reaches below the range of a logarithmic axis ends at the foot of the axis.
    const bool no_foot = y_.logarithmic && series.low[i] <= 0.0;
    result.push_back(
        {across(series.x[i]), no_foot ? bottom_ : down(series.low[i]), down(series.high[i])});
  }
  return result;
}

void Drawing::mark(int kind, double x, double y, std::string& path) const {
  constexpr double r = 4.0;
  const auto out = std::back_inserter(path);
  if (kind == 0) // a disc
    fmt::format_to(out, "M{} {}a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z", coordinate(x - r), coordinate(y));
  else if (kind == 1) // a square
    fmt::format_to(out, "M{} {}h7v7h-7z", coordinate(x - 3.5), coordinate(y - 3.5));
  else // a diamond
    fmt::format_to(out, "M{} {}l5 5l-5 5l-5-5z", coordinate(x), coordinate(y - 5.0));
}

void Drawing::draw_marks(const Series& series, const Look& look) {
  std::string path;
  for (const Place& place : places(series))
    if (!std::isnan(place.x) && !std::isnan(place.y)) mark(look.kind, place.x, place.y, path);
  if (!path.empty()) write("<path class=\"mark c{}\" d=\"{}\"/>\n", look.colour, path);
}

// Triangles that point outwards.
void Drawing::draw_rim(const std::vector<RimMark>& marks, const Look& look) {
  std::string path;
  for (const RimMark& mark : marks)
    fmt::format_to(std::back_inserter(path), "M{} {}l4.5 {}h-9z", coordinate(across(mark.x)),
                   coordinate(mark.above ? top_ : bottom_), mark.above ? 8 : -8);
  if (!path.empty()) write("<path class=\"mark rim c{}\" d=\"{}\"/>\n", look.colour, path);
}

void Drawing::draw_series(std::size_t index) {
  if (empty_) return;
  const Series& series = series_[index].inside;
  const Look& look = looks_[index];
  draw_rim(series_[index].beyond, look);
  const auto path = [&](std::string_view kind, const std::string& data) {
    if (!data.empty()) write("<path class=\"{} c{}\" d=\"{}\"/>\n", kind, look.colour, data);
  };
  switch (series.style) {
  case Series::Style::line:
    path(fmt::format("line k{}", look.kind), line_path(places(series)));
    break;
  case Series::Style::band:
    path("band", band_path(extents(series)));
    break;
  case Series::Style::bars:
    path("bar", bars_path(extents(series), 4.0));
    draw_marks(series, look);
    break;
  case Series::Style::cells:
    write("{}", cells_markup(cells(series)));
    break;
  case Series::Style::points:
    if (!look.dense) return draw_marks(series, look);
    const CloudPaths cloud = cloud_paths(places(series));
    path("body", cloud.body);
    path(fmt::format("dots k{}", look.kind), cloud.dots);
    break;
  }
}

void Drawing::draw_frame() {
  write("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", coordinate(left_),
        coordinate(top_), coordinate(right_ - left_), coordinate(plot_height));
  if (empty_)
    write(
        "<text class=\"none\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">no values to show</text>\n",
        coordinate(left_ + 0.5 * (right_ - left_)), coordinate(top_ + 0.5 * plot_height));
  write("<text class=\"axis\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
        coordinate(left_ + 0.5 * (right_ - left_)), coordinate(bottom_ + 47.0),
        escape_markup(x_.title));
  write("<text class=\"axis\" text-anchor=\"middle\" transform=\"translate(20 {}) rotate(-90)\">{}"
        "</text>\n",
        coordinate(top_ + 0.5 * plot_height), escape_markup(y_.title));
}

void Drawing::draw_sample(const Series& series, const Look& look, const LegendEntry& at) {
  const std::string begin = fmt::format("M{} {}", coordinate(at.x), coordinate(at.y));
  if (series.style == Series::Style::line) {
    write("<path class=\"line k{} c{}\" d=\"{}h28\"/>\n", look.kind, look.colour, begin);
  } else if (series.style == Series::Style::band) {
    write("<path class=\"band c{}\" d=\"{}m0-6h28v12h-28z\"/>\n", look.colour, begin);
  } else if (series.style == Series::Style::points && look.dense) {
    std::string dots;
    for (const auto& [dx, dy] : {std::array{6.0, 3.0}, {11.0, -3.0}, {16.0, 2.0}, {21.0, -1.0}})
      dots += fmt::format("M{} {}h0", coordinate(at.x + dx), coordinate(at.y + dy));
    write("<path class=\"dots k{} c{}\" d=\"{}\"/>\n", look.kind, look.colour, dots);
  } else {
    std::string path;
    mark(look.kind, at.x + 14.0, at.y, path);
    write("<path class=\"mark c{}\" d=\"{}\"/>\n", look.colour, path);
  }
}

void Drawing::draw_legend() {
  for (std::size_t i = 0; i < legend_.size(); ++i) {
    draw_sample(figure_.series[i], looks_[i], legend_[i]);
    write("<text x=\"{}\" y=\"{}\" dy=\".35em\">{}</text>\n", coordinate(legend_[i].x + 34.0),
          coordinate(legend_[i].y), escape_markup(figure_.series[i].label));
  }
}

} // namespace

std::string svg(const Figure& figure) { return Drawing(figure).text(false); }

std::string standalone_svg(const Figure& figure) { return Drawing(figure).text(true); }

std::string stacked_svg(const std::vector<Figure>& figures) {
  if (figures.size() == 1) return standalone_svg(figures.front());
  std::string stack;
  double top = 0.0;
  for (const Figure& figure : figures) {
    Drawing drawing(figure);
    const double below = top + drawing.height();
    stack += drawing.text(false, top);
    top = below;
  }
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"figure\" viewBox=\"0 0 {} {}\">\n"
      "<style>{}</style>\n{}</svg>\n",
      coordinate(width), coordinate(top), figure_style(), stack);
}

} // namespace goingrate

// Every range and every tick is given to gnuplot, so that the printed figure agrees with the figure
// on a page. Positions of the layout are in cm, those of the data in the units of the axes.
#include "gnuplot_script.hpp"

#include "figure_axes.hpp"
#include "gnuplot_series.hpp"

#include "goingrate/report/gnuplot.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

namespace {

using gnuplot::number;

constexpr double width = 8.5;
constexpr double right_margin = 0.2;
constexpr double height_alone = 5.0; // of the plot itself
constexpr double height_in_stack = 3.6;
constexpr double space_above = 0.2;
constexpr double space_between = 0.35; // of panels that share their x axis
constexpr double tick_label_row = 0.45;
constexpr double axis_title_row = 0.45;
constexpr double legend_row = 0.36;
constexpr double marker_row = 0.36;
constexpr double edge_share = 0.05;     // stays white whatever is next to it
constexpr double character = 0.14;      // width of a character at 8 points
constexpr double tick_character = 0.17; // digits are wider

std::size_t longest(const std::vector<AxisTick>& ticks) {
  std::size_t length = 0;
  for (const AxisTick& tick : ticks)
    length = std::max(length, characters(tick.label));
  return length;
}

// One figure of the stack.
struct Panel {
  const Figure& figure;
  FigureAxes axes;
  bool shares_x = false; // with the panel below it, which has the labels
  std::size_t key_rows = 0;
  std::vector<PlacedMarker> markers{};
  double top = 0.0, bottom = 0.0; // of the plot, from the upper edge
};

// Names that have no room side by side are slanted.
bool turned(const Panel& panel) {
  constexpr double room = 6.5;
  const std::size_t count = panel.figure.x.names.size();
  return character * static_cast<double>(count * (longest(panel.axes.x.ticks) + 1)) > room;
}

// If numbers have no room side by side, every second or third is kept, 0 among them.
void thin_numbers(std::vector<AxisTick>& ticks, double room) {
  const double wide = tick_character * static_cast<double>(longest(ticks) + 1);
  const auto every =
      static_cast<std::size_t>(std::ceil(wide * static_cast<double>(ticks.size()) / room));
  const auto zero = std::find_if(ticks.begin(), ticks.end(), [](const AxisTick& tick) {
    return tick.label.find_first_not_of("0.") == std::string::npos;
  });
  const auto kept = static_cast<std::size_t>(zero == ticks.end() ? 0 : zero - ticks.begin());
  for (std::size_t i = 0; i < ticks.size(); ++i)
    if (i % every != kept % every) ticks[i].label.clear();
}

double space_below(const Panel& panel) {
  if (panel.shares_x) return space_between;
  const double labels =
      turned(panel) ? 0.5 + 0.7 * character * static_cast<double>(longest(panel.axes.x.ticks))
                    : tick_label_row;
  return 0.15 + labels + (panel.axes.x.title.empty() ? 0.0 : axis_title_row);
}

std::size_t longest_label(const Figure& figure) {
  std::size_t widest = 1;
  for (const Series& series : figure.series)
    widest = std::max(widest, characters(series.label));
  return widest;
}

// Width of a label in letters: digits and the signs between them are wider, m and w widest.
double letters(const std::string& label) {
  constexpr double digit = 1.25, broad = 1.7;
  double wide = static_cast<double>(characters(label));
  for (const char c : label) {
    if ((c >= '0' && c <= '9') || c == '=' || static_cast<unsigned char>(c) >= 0xC0)
      wide += digit - 1.0;
    if (std::string_view("mwMW").find(c) != std::string_view::npos) wide += broad - 1.0;
  }
  return wide;
}

double widest_label(const Figure& figure) {
  double widest = 1.0;
  for (const Series& series : figure.series)
    widest = std::max(widest, letters(series.label));
  return widest;
}

// gnuplot sets the entries of a key in columns of one width.
std::size_t key_rows(const Figure& figure, double room) {
  if (figure.series.size() < 2) return 0;
  constexpr double sample = 1.05;
  constexpr double letter = 0.14; // width in words, which may reach beyond the plot on the right
  const double fit = (room + 0.05) / (sample + letter * widest_label(figure));
  const auto columns = static_cast<std::size_t>(std::max(fit, 1.0));
  return (figure.series.size() + columns - 1) / columns;
}

bool same_x(const Figure& a, const Figure& b) {
  return !a.group.empty() && a.group == b.group && a.x.label == b.x.label && a.x.unit == b.x.unit &&
         a.x.logarithmic == b.x.logarithmic;
}

class Script {
public:
  Script(const std::vector<Figure>& figures, double key_character) : key_character_(key_character) {
    for (std::size_t i = 0; i < figures.size(); ++i) {
      std::vector<Figure> beside;
      std::copy_if(figures.begin(), figures.end(), std::back_inserter(beside),
                   [&](const Figure& other) { return same_x(other, figures[i]); });
      panels_.push_back({figures[i], figure_axes(figures[i], beside),
                         i + 1 < figures.size() && same_x(figures[i], figures[i + 1])});
    }
    lay_out();
  }

  [[nodiscard]] double height() const { return height_; }

  std::string text() {
    write("set encoding utf8\nset border linewidth 0.7\nset tics scale 0.6,0.3\n");
    write("set rmargin at screen {:.4f}\nset lmargin at screen {:.4f}\n", right_ / width,
          left_ / width);
    if (panels_.size() > 1) write("set multiplot\n");
    for (std::size_t i = 0; i < panels_.size(); ++i)
      draw(panels_[i], i);
    if (panels_.size() > 1) write("unset multiplot\n");
    return std::move(text_);
  }

private:
  void lay_out();
  void draw(const Panel& panel, std::size_t index);
  void set_axis(char name, const AxisScale& scale, const Axis& axis, bool labelled);
  void set_key(const Panel& panel);
  void set_markers(const Panel& panel);
  [[nodiscard]] double part_of_height(double from_top) const { return 1.0 - from_top / height_; }

  template <class... Arguments>
  void write(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  std::vector<Panel> panels_;
  std::string text_;
  double key_character_;
  double left_ = 0.0, right_ = width - right_margin;
  double height_ = 0.0;
};

void Script::lay_out() {
  for (const Panel& panel : panels_) {
    const double axis_title = panel.axes.y.title.empty() ? 0.35 : 0.85;
    left_ = std::max(left_, axis_title +
                                tick_character * static_cast<double>(longest(panel.axes.y.ticks)));
    right_ =
        std::min(right_, width - edge_share - tick_character * half_of_last_label(panel.axes.x));
  }
  const double plot_height = panels_.size() > 1 ? height_in_stack : height_alone;
  for (Panel& panel : panels_) {
    if (AxisScale& x = panel.axes.x; !x.logarithmic && panel.figure.x.names.empty())
      thin_numbers(x.ticks, right_ - left_);
    panel.key_rows = key_rows(panel.figure, right_ - left_);
    panel.markers = place_markers(panel.figure, panel.axes, character / (right_ - left_),
                                  0.1 / (right_ - left_));
    panel.top = height_ + space_above + legend_row * static_cast<double>(panel.key_rows) +
                marker_row * static_cast<double>(rows_of(panel.markers));
    panel.bottom = panel.top + plot_height;
    height_ = panel.bottom + space_below(panel);
  }
}

// gnuplot reads a tick's label as a format, so % is doubled.
std::string tick_label(const std::string& label) {
  std::string text;
  for (const char c : label)
    text += c == '%' ? std::string("%%") : std::string(1, c);
  return gnuplot::quoted(text);
}

std::string ticks_text(const AxisScale& scale, bool labelled) {
  std::string text;
  for (const AxisTick& tick : scale.ticks) {
    if (!text.empty()) text += ", ";
    text +=
        tick_label(labelled ? tick.label : "") + " " + number(gnuplot::value_at(scale, tick.place));
    text += tick.label.empty() ? " 1" : " 0";
  }
  return text;
}

void Script::set_axis(char name, const AxisScale& scale, const Axis& axis, bool labelled) {
  write("{} logscale {}\n", scale.logarithmic ? "set" : "unset", name);
  write("set {}range [{}:{}]\n", name, number(gnuplot::value_at(scale, 0.0)),
        number(gnuplot::value_at(scale, 1.0)));
  if (scale.ticks.empty())
    write("unset {}tics\n", name);
  else
    write("set {}tics {} ({})\n", name, axis.names.empty() ? "mirror" : "nomirror scale 0",
          ticks_text(scale, labelled));
  write("set {}label {}\n", name, gnuplot::quoted(labelled ? scale.title : ""));
}

void Script::set_key(const Panel& panel) {
  if (panel.key_rows == 0) return write("unset key\n");
  const double top = panel.top - marker_row * static_cast<double>(rows_of(panel.markers)) -
                     legend_row * static_cast<double>(panel.key_rows) - 0.05;
  write("set key at graph 0, screen {:.4f} left top Left reverse vertical maxrows {} samplen 1.4 "
        "width {:.1f}\n",
        part_of_height(top), panel.key_rows,
        widest_label(panel.figure) -
            (1.0 + key_character_) * static_cast<double>(longest_label(panel.figure)));
}

void Script::set_markers(const Panel& panel) {
  write("unset arrow\nunset label\n");
  if (panel.axes.empty) {
    write("set label 'no values to show' at graph 0.5,0.5 center\n");
    return;
  }
  for (const PlacedMarker& placed : panel.markers) {
    const double middle = panel.top - marker_row * (0.5 + static_cast<double>(placed.row));
    write("set arrow from first {0}, graph 0 to first {0}, graph 1 nohead back linewidth 0.7 "
          "dashtype (4,4) linecolor rgb '#555555'\n",
          number(placed.marker->x));
    write("set label {} at graph {:.4f}, screen {:.4f} center front\n",
          gnuplot::quoted(placed.marker->label), placed.centre, part_of_height(middle));
  }
}

void Script::draw(const Panel& panel, std::size_t index) {
  write("\n# {}\n", gnuplot::commented(panel.figure.title));
  write("set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\n", part_of_height(panel.top),
        part_of_height(panel.bottom));
  set_axis('x', panel.axes.x, panel.figure.x, !panel.shares_x);
  write("set xtics {}\n", turned(panel) ? "rotate by 45 right" : "norotate");
  set_axis('y', panel.axes.y, panel.figure.y, true);
  set_key(panel);
  set_markers(panel);
  const std::vector<Look> looks = series_looks(panel.figure);
  std::string curves;
  for (std::size_t i = 0; i < panel.figure.series.size() && !panel.axes.empty; ++i) {
    const gnuplot::Curves series =
        gnuplot::curves(panel.figure.series[i], looks[i], panel.axes,
                        {fmt::format("$panel{}_{}", index + 1, i + 1), panel.key_rows > 0});
    text_ += series.data;
    if (!series.plots.empty()) curves += (curves.empty() ? "" : ", \\\n     ") + series.plots;
  }
  write("plot {}\n", curves.empty() ? "NaN notitle" : curves);
}

// By how much a terminal overestimates a word's width, in characters per character.
constexpr double pdf_key_character = 0.27;
constexpr double png_key_character = 0.15;

constexpr const char* manner = "font 'sans,8' noenhanced rounded";

std::string pdf_terminal(double height) {
  return fmt::format("set terminal pdfcairo size {}cm,{:.2f}cm {} fontscale 0.75 linewidth 1\n",
                     width, height, manner);
}

} // namespace

std::string gnuplot_script(const std::vector<Figure>& figures, std::string_view name) {
  Script script(figures, pdf_key_character);
  std::string output; // without characters that could end a quoted string
  for (const char c : std::string(name) + ".pdf")
    output += c == '\'' || static_cast<unsigned char>(c) < ' ' ? '_' : c;
  std::string head = "# A script for gnuplot 5 with its data inside: it writes " +
                     gnuplot::commented(output) + ".\n";
  for (const Figure& figure : figures)
    head +=
        "# " + gnuplot::commented(figure.title) + ". " + gnuplot::commented(figure.caption) + "\n";
  return head + pdf_terminal(script.height()) + "set output " + gnuplot::quoted(output) + "\n" +
         script.text();
}

std::string script_for_pdf(const std::vector<Figure>& figures) {
  Script script(figures, pdf_key_character);
  return pdf_terminal(script.height()) + script.text();
}

std::string script_for_png(const std::vector<Figure>& figures) {
  Script script(figures, png_key_character);
  constexpr double dots = 300.0 / 2.54;  // per cm
  constexpr double scale = 300.0 / 96.0; // the terminal takes a dot for 1/96 inch
  return fmt::format(
             "set terminal pngcairo size {:.0f},{:.0f} {} fontscale {:.3f} linewidth {:.3f} "
             "pointscale {:.3f} dashlength 2\n",
             dots * width, dots * script.height(), manner, scale, 0.7 * scale, scale) +
         script.text();
}

} // namespace goingrate

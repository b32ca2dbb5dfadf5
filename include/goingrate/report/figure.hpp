// Figures as SVG text, small enough to sit in a page and clear enough to print.
//
// A figure is described by plain structs; nothing here depends on what is plotted. A long series is
// thinned to the columns of the drawing (one unit of its width) so that its extremes stay: a line
// keeps the lowest and highest point of each column; a cloud of more than 1000 points keeps these
// as dots, and draws the middle 80 % of the column as a stroke. A value that is not finite, or that
// its axis cannot show (zero or negative on a logarithmic one), is left out and breaks a line.
#pragma once

#include <string>
#include <vector>

namespace goingrate {

/// One set of values. `low` and `high` are the limits of a band or of error bars, else empty; `low`
/// also holds the numbers of cells.
struct Series {
  /// How the values are drawn.
  enum class Style {
    line,   ///< points joined in the order given; x should not decrease
    points, ///< dots
    band,   ///< the area between `low` and `high`; y is not used
    bars,   ///< a mark at y with a bar from `low` to `high` where both are known
    cells,  ///< a square of side 1 about (x, y) for each number from -1 to 1 in `low`
  };
  Style style = Style::line;
  std::string label; ///< for the legend, which is drawn if the figure has more than one series
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> low{};
  std::vector<double> high{};
  int colour = 0; ///< 0 to 7: place in the colour-blind safe palette of Okabe and Ito
};

/// One axis, in the unit its values have.
struct Axis {
  std::string label; ///< name of the quantity, without its unit
  std::string unit;  ///< may be empty
  bool logarithmic = false;
  std::vector<std::string> names{}; ///< labels at 0, 1, 2 ...; empty: an axis of numbers
};

/// A vertical line at x; left out if x lies outside the drawing.
struct Marker {
  double x = 0.0;
  std::string label;
};

/// The content of a plot; how it looks is decided when it is drawn.
struct Figure {
  std::string id; ///< unique in its page
  std::string title;
  std::string caption; ///< becomes the description read out by a screen reader
  Axis x;
  Axis y;
  std::vector<Series> series;
  std::vector<Marker> markers{};
  std::string group{}; ///< figures of one group share their x axis where a page draws them live
};

/// The figure as an svg element without width and height: it takes the width it is given. Colours
/// and lines come from `figure_style`, which the page must contain once. Size: below 100 bytes for
/// each of the 626 columns and each series of any length (FigureTest.ALongSeriesStaysSmall). Cost
/// O(N log N). Throws ArgumentError if the vectors of a series differ in length.
std::string svg(const Figure& figure);

/// The same as a file of its own, with its style inside.
std::string standalone_svg(const Figure& figure);

/// Figures one above the other as one file; their ids must differ.
std::string stacked_svg(const std::vector<Figure>& figures);

/// The numbers of a figure as CSV: the series, x and y with the labels and units of their axes, and the
/// ends low and high of bars and bands; a field without a number is empty.
std::string figure_csv(const Figure& figure);

/// The CSS of all figures. Custom properties change its colours: --text, --grid, --paper and
/// --c0 to --c7.
std::string figure_style();

} // namespace goingrate

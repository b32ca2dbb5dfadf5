// The ranges, ticks and looks of a figure, which every way of drawing it needs first.
#pragma once

#include "axis_scale.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// Both axes of a figure.
struct FigureAxes {
  AxisScale x, y;
  bool empty = false;   ///< there is no value that can be shown
  bool clipped = false; ///< some values of clouds lie beyond the y axis
};

/// The axes that show all values of `figure`, with room at the edges; the x axis also has room for
/// the figures of `beside`, which share it. If there is a cloud of points and y is linear, the bulk
/// of the points and lines sets the y axis, so that a single bad period does not hide all others: a
/// value that lies farther from the middle 98 % of its series than their range is wide is left
/// outside. Throws ArgumentError if the vectors of a series differ in length.
FigureAxes figure_axes(const Figure& figure, const std::vector<Figure>& beside = {});

/// A value of a cloud that lies beyond the y axis.
struct RimMark {
  double x = 0.0;
  bool above = false; ///< beyond the upper end
};

/// A series inside the axes: points beyond the y axis are moved to `beyond`, at most one on each
/// side for each 150th part of the x axis; a line beyond it runs along the edge instead.
struct SeriesWithin {
  Series inside;
  std::vector<RimMark> beyond;
};
SeriesWithin within(const Series& series, const FigureAxes& axes);

/// What makes a series differ from the others, with and without its colour.
struct Look {
  int colour = 0;     ///< 0 to 7
  int kind = 0;       ///< of dash (0 to 3) or of mark (0 to 2), among the series of the same manner
  bool dense = false; ///< too many dots for large ones
};

/// The look of each series.
std::vector<Look> series_looks(const Figure& figure);

/// One of the eight colours of Okabe and Ito, which colour-blind readers can tell apart, as
/// #RRGGBB.
std::string_view palette(int colour);

/// How far the last label of an x axis may reach beyond the plot: half its length, in characters; 0
/// if it is inside.
double half_of_last_label(const AxisScale& x);

/// A marker inside the drawing and the place of its label, which is above the plot so that it
/// covers nothing that is drawn.
struct PlacedMarker {
  const Marker* marker;
  double centre;   ///< of the label, 0 to 1 along the axis
  std::size_t row; ///< from the plot upwards, 0 to 3
};

/// The markers inside the drawing, each label in the first row that has room for it; if all four
/// rows are full, labels overlap, beginning in the lowest row. `character` is the width of one
/// character and `apart` the gap between two labels, as parts of the plot's width.
std::vector<PlacedMarker> place_markers(const Figure& figure, const FigureAxes& axes,
                                        double character, double apart);
/// How many rows the markers' labels take.
std::size_t rows_of(const std::vector<PlacedMarker>& markers);

/// The number of characters of a UTF-8 text.
std::size_t characters(std::string_view text);

} // namespace goingrate

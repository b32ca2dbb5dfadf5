// What every way of drawing a figure has to find out first: ranges, ticks, looks.
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

/// The axes that show all values of `figure`, with room at the edges; x shows those of `beside`
/// too, figures that have the same x axis. Where there is a cloud of points and y is linear, the
/// values of points and lines set the y axis by their bulk, so that a single bad period does not
/// hide all others: one that lies farther from the range of the middle 98 % of its series than that
/// range is wide is left outside. Throws ArgumentError if the vectors of a series differ in length.
FigureAxes figure_axes(const Figure& figure, const std::vector<Figure>& beside = {});

/// A value of a cloud that lies beyond the y axis.
struct RimMark {
  double x = 0.0;
  bool above = false; ///< beyond the upper end
};

/// A series inside the axes: points beyond the y axis are missing and stand in `beyond`, at most
/// one for each side and 150th part of the x axis; a line runs along the rim there.
struct SeriesWithin {
  Series inside;
  std::vector<RimMark> beyond;
};
SeriesWithin within(const Series& series, const FigureAxes& axes);

/// How one series is told from the others without its colour.
struct Look {
  int colour = 0;     ///< 0 to 7
  int kind = 0;       ///< of dash (0 to 3) or of mark (0 to 2), among the series of the same manner
  bool dense = false; ///< too many dots for large ones
};

/// One for each series.
std::vector<Look> series_looks(const Figure& figure);

/// The eight colours of Okabe and Ito that the colour-blind tell apart, as #RRGGBB.
std::string_view palette(int colour);

/// Half the length of the last label of an x axis, in characters: how far it may reach beyond the
/// plot. 0 if it stands inside.
double half_of_last_label(const AxisScale& x);

/// A marker inside the drawing and where its label stands: above the plot, so that it covers
/// nothing that is drawn.
struct PlacedMarker {
  const Marker* marker;
  double centre;   ///< of the label, 0 to 1 along the axis
  std::size_t row; ///< from the plot upwards, 0 to 3
};

/// The markers inside the drawing, each label in the first row that has room for it; where all four
/// are full, labels overlap from the lowest row on. `character`
/// and `apart`: width of one and what is left between two labels, as parts of the plot's width.
std::vector<PlacedMarker> place_markers(const Figure& figure, const FigureAxes& axes,
                                        double character, double apart);
/// How many rows their labels take.
std::size_t rows_of(const std::vector<PlacedMarker>& markers);

/// The number of characters of a UTF-8 text.
std::size_t characters(std::string_view text);

} // namespace goingrate

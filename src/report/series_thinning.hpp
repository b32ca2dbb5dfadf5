// Thins series to the columns of a drawing, one unit of x each, without a visible change.
#pragma once

#include <string>
#include <vector>

namespace goingrate {

/// A place in the drawing, in its units; NaN where a value is missing.
struct Place {
  double x;
  double y;
};

/// The ends of a bar or of a band at x. y grows downwards, so that `low` is the larger.
struct Extent {
  double x;
  double low;
  double high;
};

/// A point cloud: dots, and strokes where it is too dense to show as dots.
struct Cloud {
  std::vector<Place> dots;
  std::vector<Extent> body;
};

/// The runs of a line, which is broken where a place is missing: the lowest and the highest place
/// in each column, in their order. A place with gaps on both sides is a run of one.
std::vector<std::vector<Place>> thinned_line(const std::vector<Place>& places);

/// Up to 1000 places are all drawn as dots. If there are more, a column with more than two places
/// becomes two dots, the lowest and the highest, and a stroke over the middle 80 %.
Cloud thinned_cloud(const std::vector<Place>& places);

/// The runs of a band: the outline of its extents in each column.
std::vector<std::vector<Extent>> thinned_band(const std::vector<Extent>& extents);

} // namespace goingrate

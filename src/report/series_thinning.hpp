// Series thinned to the columns of a drawing, one unit of x each, so that what is seen stays.
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

/// A point cloud: dots, and strokes for what is too dense to show as dots.
struct Cloud {
  std::vector<Place> dots;
  std::vector<Extent> body;
};

/// The runs of a line, which is broken where a place is missing: in each column the lowest and the
/// highest place, in their order. A place with gaps on both sides is a run of one.
std::vector<std::vector<Place>> thinned_line(const std::vector<Place>& places);

/// Up to 1000 places are all drawn as dots. If there are more, those in a column with more than two
/// become two dots, the lowest and the highest, and a stroke over the middle 80 %.
Cloud thinned_cloud(const std::vector<Place>& places);

/// The runs of a band: in each column the outline of its extents.
std::vector<std::vector<Extent>> thinned_band(const std::vector<Extent>& extents);

} // namespace goingrate

// Series as SVG path data, thinned to the columns of the drawing.
#pragma once

#include <string>
#include <vector>

namespace goingrate {

/// A place in the drawing, in its units; NaN where a value is missing.
struct Place {
  double x;
  double y;
};

/// The ends of a bar or of a band at x.
struct Extent {
  double x;
  double low;
  double high;
};

/// A point cloud: dots, and strokes for what is too dense to show as dots.
struct CloudPaths {
  std::string dots;
  std::string body;
};

/// The line through the places, broken where one is missing: of the places in one column the lowest
/// and the highest, in their order. A place with gaps on both sides becomes a dot.
std::string line_path(const std::vector<Place>& places);

/// The places as dots. In a column with more than two, the lowest and the highest are dots and the
/// middle 80 % a stroke.
CloudPaths cloud_paths(const std::vector<Place>& places);

/// The outline of a band, one piece for each unbroken run.
std::string band_path(const std::vector<Extent>& extents);

/// Bars with caps of half width `cap`.
std::string bars_path(const std::vector<Extent>& extents, double cap);

/// A coordinate with one decimal, or none if that is zero.
std::string coordinate(double value);

} // namespace goingrate

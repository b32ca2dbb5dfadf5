// Writes series as SVG path data, thinned to the columns of the drawing.
#pragma once

#include "series_thinning.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// A point cloud as paths.
struct CloudPaths {
  std::string dots;
  std::string body;
};

/// The line through the places, broken where one is missing. A place with gaps on both sides
/// becomes a dot.
std::string line_path(const std::vector<Place>& places);

/// The places as dots, and as strokes where they are dense.
CloudPaths cloud_paths(const std::vector<Place>& places);

/// The outline of a band, one piece for each unbroken run.
std::string band_path(const std::vector<Extent>& extents);

/// Bars with caps of half width `cap`.
std::string bars_path(const std::vector<Extent>& extents, double cap);

/// A coordinate with one decimal, or none if that is zero.
std::string coordinate(double value);

} // namespace goingrate

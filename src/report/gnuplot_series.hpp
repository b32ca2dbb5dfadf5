// Writes one series of a figure as data and plotting commands for gnuplot.
#pragma once

#include "figure_axes.hpp"

#include <string>
#include <string_view>

namespace goingrate::gnuplot {

/// The value at a place on the axis, 0 to 1.
double value_at(const AxisScale& scale, double place);

std::string number(double value);

/// Text that is safe inside gnuplot's apostrophes: control characters become blanks, and
/// apostrophes become typographic ones.
std::string quoted(std::string_view text);

/// Text that is safe in a comment line.
std::string commented(std::string_view text);

/// Blocks of data, and the arguments of gnuplot's command `plot`.
struct Curves {
  std::string data;
  std::string plots;
};

struct CurveOptions {
  std::string name;    ///< of the blocks of data
  bool titled = false; ///< it has an entry in the key
};

Curves curves(const Series& series, const Look& look, const FigureAxes& axes,
              const CurveOptions& options);

} // namespace goingrate::gnuplot

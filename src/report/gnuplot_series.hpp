// One series of a figure as data and plotting commands of gnuplot.
#pragma once

#include "figure_axes.hpp"

#include <string>
#include <string_view>

namespace goingrate::gnuplot {

/// The value at a place from 0 to 1.
double value_at(const AxisScale& scale, double place);

std::string number(double value);

/// Text that is safe between gnuplot's apostrophes: control characters become blanks, apostrophes
/// typographic ones.
std::string quoted(std::string_view text);

/// Text for a comment line.
std::string commented(std::string_view text);

/// Blocks of data, and what stands behind `plot`.
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

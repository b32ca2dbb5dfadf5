// A matrix of numbers as coloured squares.
#pragma once

#include <string>
#include <vector>

namespace goingrate {

/// One square, in units of the drawing, and its number from -1 to 1.
struct Cell {
  double left, top, width, height;
  double value;
};

/// The squares: blue where positive, vermilion where negative, the fuller the larger, each with its
/// number. One that is not finite is left out.
std::string cells_markup(const std::vector<Cell>& cells);

} // namespace goingrate

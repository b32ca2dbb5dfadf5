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

/// The squares with their numbers: blue if positive, vermilion if negative, in a stronger shade the
/// larger the number. A number that is not finite is left out.
std::string cells_markup(const std::vector<Cell>& cells);

} // namespace goingrate

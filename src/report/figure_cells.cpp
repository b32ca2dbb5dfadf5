#include "figure_cells.hpp"

#include "markup.hpp"
#include "series_path.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

std::string cells_markup(const std::vector<Cell>& cells) {
  constexpr double fullest_share = 0.8; // the number on it stays readable
  std::string text;
  for (const Cell& cell : cells) {
    if (!std::isfinite(cell.value)) continue;
    const double size = std::min(1.0, std::abs(cell.value));
    const double shown = size < 0.005 ? 0.0 : cell.value; // no "-0.00"
    fmt::format_to(std::back_inserter(text),
                   "<rect class=\"cell c{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" "
                   "fill-opacity=\"{:.2f}\"/>\n"
                   "<text x=\"{}\" y=\"{}\" dy=\".35em\" text-anchor=\"middle\">{}</text>\n",
                   cell.value < 0.0 ? 1 : 0, coordinate(cell.left), coordinate(cell.top),
                   coordinate(cell.width), coordinate(cell.height), fullest_share * size,
                   coordinate(cell.left + 0.5 * cell.width),
                   coordinate(cell.top + 0.5 * cell.height), typeset(fmt::format("{:.2f}", shown)));
  }
  return text;
}

} // namespace goingrate

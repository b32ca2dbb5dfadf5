// Figures for print, drawn by gnuplot, which must be installed separately.
#pragma once

#include "goingrate/report/figure.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

enum class PrintFormat {
  pdf, ///< 8.5 cm wide, a column of most journals
  png, ///< the same at 300 dots per inch
};

/// The figures one above the other as a script for gnuplot 5 that contains their data and writes
/// `name`.pdf. Long series are thinned as in `svg`, to a resolution of 300 dots per inch. The text
/// of a figure is quoted so that gnuplot never takes it for a command. Figures of one group share
/// their x axis. Throws ArgumentError if the vectors of a series differ in length.
std::string gnuplot_script(const std::vector<Figure>& figures, std::string_view name);

/// A hundred times as long as a figure usually takes, to allow for slow and busy machines.
inline constexpr std::chrono::milliseconds gnuplot_patience = std::chrono::seconds(20);

/// Whether gnuplot can be run; it is looked for in PATH, as a shell does.
bool gnuplot_is_installed();

/// The figures, one above the other, as the bytes of a file in that format; nullopt if gnuplot is
/// not installed. If gnuplot fails, or does not end within `patience` and is killed, throws
/// OutputError with what gnuplot said; the error names `target`, the file that the figures are for.
/// Cost: some 0.1 s.
std::optional<std::string> printed_figure(const std::vector<Figure>& figures, PrintFormat format,
                                          const std::string& target,
                                          std::chrono::milliseconds patience = gnuplot_patience);

} // namespace goingrate

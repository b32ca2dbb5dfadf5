// Figures drawn for print by gnuplot, a program of its own.
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

/// The figures one above the other as a script for gnuplot 5, with their data inside: run by itself
/// it writes `name`.pdf. Long series are thinned as in `svg`, to the dots of 300 to the inch.
/// gnuplot takes no text of a figure for a command. Figures of one group share their x axis. Throws
/// ArgumentError if the vectors of a series differ in length.
std::string gnuplot_script(const std::vector<Figure>& figures, std::string_view name);

/// A hundred times what a figure takes, for slow and busy machines.
inline constexpr std::chrono::milliseconds gnuplot_patience = std::chrono::seconds(20);

/// Whether there is a gnuplot to be run; it is sought as a shell would, in PATH.
bool gnuplot_is_installed();

/// The figures, one above the other, as a file of that format; nothing if gnuplot is not installed.
/// `target` is the file they are meant for, named where gnuplot fails: that throws OutputError with
/// what gnuplot said, or that it did not end within `patience` and was killed. Cost: some 0.1 s.
std::optional<std::string> printed_figure(const std::vector<Figure>& figures, PrintFormat format,
                                          const std::string& target,
                                          std::chrono::milliseconds patience = gnuplot_patience);

} // namespace goingrate

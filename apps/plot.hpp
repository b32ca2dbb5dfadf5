// Figures as files: what --plot and the folders of figures have in common.
#pragma once

#include "common.hpp"

#include "goingrate/report/report.hpp"

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace goingrate::apps {

/// Paths and what is to be written there.
using Files = std::vector<std::pair<std::string, std::string>>;

/// Adds --plot. Another extension than .svg, .pdf, .png and .gp is wrong usage; a missing gnuplot
/// is found out before the work.
CLI::Option* add_plot_option(CLI::App& command, std::string& path, const std::string& what);

/// The figures, one above the other, as the extension of `path` asks for; nothing for an empty
/// path.
std::string plotted(const std::string& path, const std::vector<Figure>& figures);

/// What the figures of a log need, as far as it is known without a fit.
Analysis drawn_data(const NumberedLog& loaded);

/// The figures of a report that have these ids.
std::vector<Figure> figures_named(const Analysis& data,
                                  std::initializer_list<std::string_view> ids);

/// The path of `name` in `folder`, which is made if need be.
std::string inside(const std::string& folder, const std::string& name);

/// Adds a figure as NAME.svg, NAME.csv, NAME.gp and, if there is a gnuplot, NAME.pdf and NAME.png.
void add_figure(const std::string& folder, const std::string& name, const Figure& figure,
                Files& files);

/// Says that PDF and PNG are missing if there is no gnuplot.
void tell_of_missing_gnuplot(const GlobalOptions& global);

} // namespace goingrate::apps

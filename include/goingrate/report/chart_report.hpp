// The chart of methods, their limits, and rate maps, as text, JSON and figures.
#pragma once

#include "goingrate/dynamics/chart.hpp"
#include "goingrate/dynamics/operating_point.hpp"
#include "goingrate/dynamics/rate_map.hpp"
#include "goingrate/report/figure.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// One table per scene, from fast to slow; a star marks the frontier. The last column is the error
/// in seconds of a clock of the given nominal period.
std::string chart_text(const std::vector<ChartRow>& rows, double nominal_period_s);

/// {"rows": [{method, setting, scenario, ns_per_period, max_error, setup_us, status}]}; max_error
/// in scaled time.
std::string chart_json(const std::vector<ChartRow>& rows);

/// Error against time per period for one scene, with the frontier joined and the sensor's jitter
/// (s) as a line: for that sensor all methods below the line are equally good.
Figure chart_figure(const std::vector<ChartRow>& rows, const std::string& scene,
                    double nominal_period_s, double jitter_s);

/// One line per point: the errors of each method, and which approximation fails first.
std::string limits_text(const std::vector<LimitRow>& rows);
std::string limits_json(const std::vector<LimitRow>& rows);

std::string rate_map_table(const RateMap& map); ///< CSV: epsilon,mu,rate_excess,rate_s_per_day
std::string rate_map_json(const RateMap& map);
/// The rate against friction, with a curve for each of some torques. If some rates are so far from
/// the rest that the other curves cannot be told apart, a second figure shows the rates near
/// nominal alone. `points` are marked.
std::vector<Figure> rate_map_figures(const RateMap& map,
                                     const std::vector<OperatingPoint>& points = {});
/// Rates below 1e-15, the accuracy to which the equations are solved, are written as 0.
std::string operating_points_text(const std::vector<OperatingPoint>& points, double phi0);
std::string operating_points_json(const std::vector<OperatingPoint>& points, double phi0);

} // namespace goingrate

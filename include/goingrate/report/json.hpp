// Results as JSON text: every key that scripts rely on, numbers with all their digits, and null
// instead of NaN for a number that is not known.
#pragma once

#include "goingrate/log/amplitude.hpp"
#include "goingrate/report/report.hpp"

#include <string>

namespace goingrate {

std::string rate_json(const ClockLog& log, const Beats& beats, const RateSummary& summary,
                      const SensorFindings& sensor = {});
std::string fit_json(const FitSummary& fit);
std::string spectrum_json(const DriveAnalysis& drive);
std::string stability_json(const DeviationTable& table);
/// For a log of more than some 8000 beats the spectrum is averaged in 300 bands per decade of
/// frequency ("averaged_in_bands"); spectrum_json() has all of it.
std::string report_json(const Analysis& data);
/// The JSON of report_json() on one line, without a character that could open or close an HTML
/// element.
std::string report_json_for_script(const Analysis& data);

} // namespace goingrate

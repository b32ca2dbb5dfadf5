// Parts from which the JSON results are made.
#pragma once

#include "goingrate/fit/decay.hpp"
#include "goingrate/report/json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace goingrate {

using Json = nlohmann::ordered_json;

/// null for a number that is not known: JSON has no NaN.
inline Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json decay_object(const Decay& decay);

/// The text of a JSON value made safe inside <script>: "</script" must not occur there, so every
/// "<", which JSON has only in strings, is escaped.
inline std::string safe_in_script(const std::string& json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

inline Json json_with_schema(const char* name) { return {{"schema", name}, {"version", 1}}; }

/// A value as JSON text in several lines. Bytes that are not UTF-8, as in a file name in another
/// encoding, are written as replacement characters.
std::string json_text(const Json& json);

// The results that the report's JSON contains.
Json part_object(const PartRate& part, bool nominal_is_known);
Json rate_object(const ClockLog& log, const Beats& beats, const RateSummary& summary,
                 const SensorFindings& sensor);
Json fit_object(const FitSummary& fit);
Json spectrum_object(const DriveAnalysis& drive);
Json stability_object(const DeviationTable& table);

} // namespace goingrate

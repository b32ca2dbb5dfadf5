// What people ask of a fit, in their own words, as options of the fit of one log.
#pragma once

#include "goingrate/analysis/load.hpp"
#include "goingrate/fit/clock_fit.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace goingrate {

/// What a fit is to do; empty: not given. Names are those of FitOptions.
struct FitRequest {
  std::vector<std::pair<std::string, double>> fixed{};
  std::vector<std::string> freed{};
  std::vector<Prior> priors{};
  /// "150:mu,epsilon" changes at a cycle of the log, "300s:mu" at the beat next to that time after
  /// the first; or the one word "auto" (those of the diary) or "none".
  std::vector<std::string> events{};
  std::string model{}, noise{}, escapement{}; ///< words of par files
  std::string from{};                         ///< a par file, or "-"; what else is given wins
};

/// Whether changes are searched for: neither the request nor its file names any, or "auto".
bool finds_events(const FitRequest& request);
/// The same request, but searching for changes where it names none.
FitRequest searching(FitRequest request);

/// The options of a fit of this log, with the sensor's place free where the log shows that it is
/// off (with_seen_offset), and the share of gravity held at the one the log was read with. Throws
/// ArgumentError for a word that makes no sense, InputError if the file is unusable or asks for
/// what the log cannot give.
FitOptions fit_options(const FitRequest& request, const NumberedLog& loaded);

/// "NAME=VALUE"; throws ArgumentError, as the two below do.
std::pair<std::string, double> parse_fixed(const std::string& text);
/// "NAME=VALUE+-SIGMA"; the sign may be "±", as results print it.
Prior parse_prior(const std::string& text);
/// A decimal number and nothing else; `name` is what messages call it.
double number_in(std::string_view name, std::string_view text);

} // namespace goingrate

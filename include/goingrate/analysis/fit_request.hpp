// A fit as the user asks for it, in text, and its translation into the options for one log.
#pragma once

#include "goingrate/analysis/load.hpp"
#include "goingrate/fit/clock_fit.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace goingrate {

/// What a fit is to do; an empty member was not given. Parameters are named as in FitOptions.
struct FitRequest {
  std::vector<std::pair<std::string, double>> fixed{};
  std::vector<std::string> freed{};
  std::vector<Prior> priors{};
  /// "150:mu,epsilon" changes parameters at a cycle of the log; "300s:mu" at the first beat 300 s
  /// or more after the first one, which the fit may then shift by some cycles. Or the one word
  /// "auto" (the changes of the diary) or "none".
  std::vector<std::string> events{};
  std::string model{}, noise{}, escapement{}; ///< words of par files
  std::string from{}; ///< a par file, or "-" for standard input; the other members override it
};

/// Whether the fit searches for changes: the events are "auto", or neither events nor a file are
/// given.
bool finds_events(const FitRequest& request);
/// The same request, but searching for changes where it names none.
FitRequest searching(FitRequest request);

/// The options of a fit of this log. The sensor's offset is free where the log shows one
/// (with_seen_offset), and the share of gravity is held at the one the log was read with. Throws
/// ArgumentError for a word that is not allowed, InputError if the file is unusable or asks for
/// what the log cannot give.
FitOptions fit_options(const FitRequest& request, const NumberedLog& loaded);

/// Reads "NAME=VALUE"; throws ArgumentError for any other text, as the two functions below do.
std::pair<std::string, double> parse_fixed(const std::string& text);
/// Reads "NAME=VALUE+-SIGMA"; the sign may also be "±", as results print it.
Prior parse_prior(const std::string& text);
/// A decimal number and nothing else; `name` is what messages call it.
double number_in(std::string_view name, std::string_view text);

} // namespace goingrate

// A fit as a text that can be edited and fed back.
//
//   # goingrate par 1
//   DYNAMICS map                  averaged1, averaged2, map or auto
//   ESCAPEMENT constant-torque    single-impulse, none or auto
//   NOISE jitter                  drive, both, slow or auto
//   EVENT 150 mu,epsilon          these change at this cycle; the k-th EVENT gives mu@k
//   PRIOR lambda0 0.05 0.005      known from elsewhere: value and sigma
//   T0 2 0                        NAME VALUE 0: held at VALUE
//   epsilon 0.00025 1 1e-08       NAME VALUE 1 [SIGMA]: fitted, the search starts at VALUE
//   mu - 1                        fitted, no start known
//
// One item a line, in any order after the first line; blanks separate the columns; what follows a #
// is a comment.
#pragma once

#include "goingrate/base/errors.hpp"
#include "goingrate/fit/clock_fit.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// What a file asks for, and where it says so, as only a log can show some of it to be wrong.
struct ParFile {
  FitOptions
      options; ///< its events at the cycles of the file, not yet counted from the data's first
  std::map<std::string, TextPlace> parameter_places;
  std::vector<TextPlace> event_places;
};

/// The text that repeats `fit`: what was chosen automatically is named, with 17 digits each value.
/// A noise that has no name of its own (a random walk) stays `auto`. `first_cycle` is added to the
/// cycles of the events.
std::string par_text(const FitSummary& fit, const FitOptions& options, std::int64_t first_cycle);

/// Reads such a text; `file` names it in messages. Throws InputError with line and column for
/// whatever is not an item, is given twice, is out of range or changes at no event.
ParFile parse_par(std::string_view text, const std::string& file);

/// A start serves only if it has a value for every parameter of the clock that is not fixed; one
/// that has not is dropped, and the search then begins as without it. Sizes of the noise, and what
/// may be zero, are guessed from the log where they are missing.
void drop_partial_start(FitOptions& options);

/// The names of all parameters. A value after the k-th event has the event's number after the
/// name, as in "mu\@1".
std::vector<std::string> parameter_names();
/// The names of those that are fitted only where they are named.
std::vector<std::string> optional_parameter_names();

/// Set the option by the word for it, `auto` included; false for any other word.
bool set_dynamics(FitOptions& options, std::string_view word);
bool set_noise(FitOptions& options, std::string_view word);
bool set_escapement(FitOptions& options, std::string_view word);

} // namespace goingrate

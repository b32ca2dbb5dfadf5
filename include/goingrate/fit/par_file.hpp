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

/// The options in a file, and their lines, since some errors show only when a log is known.
struct ParFile {
  FitOptions
      options; ///< its events at the cycles of the file, not yet counted from the data's first
  std::map<std::string, TextPlace> parameter_places;
  std::vector<TextPlace> event_places;
};

/// The text that makes another run repeat `fit`: automatic choices are written by name, and values
/// with 17 digits. A noise without a name of its own (a random walk) stays `auto`. `first_cycle` is
/// added to the cycles of the events.
std::string par_text(const FitSummary& fit, const FitOptions& options, std::int64_t first_cycle);

/// Reads such a text; `file` names it in messages. Throws InputError with line and column for
/// whatever is not an item, is given twice, is out of range or changes at no event.
ParFile parse_par(std::string_view text, const std::string& file);

/// Drops start values that do not cover every parameter of the clock that is not fixed; the search
/// then begins as without them. Missing sizes of the noise, and of parameters that may be zero, are
/// guessed from the log.
void drop_partial_start(FitOptions& options);

/// The names of all parameters. A value after the k-th event has the event's number after the
/// name, as in "mu\@1".
std::vector<std::string> parameter_names();
/// The names of the parameters that are fitted only on request.
std::vector<std::string> optional_parameter_names();

/// Set an option by its word, including `auto`; false for any other word.
bool set_dynamics(FitOptions& options, std::string_view word);
bool set_noise(FitOptions& options, std::string_view word);
bool set_escapement(FitOptions& options, std::string_view word);

} // namespace goingrate

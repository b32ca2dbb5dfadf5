// What the keeper of a clock wrote down, beside what its log shows.
#pragma once

#include "goingrate/causes/diary.hpp"
#include "goingrate/log/beats.hpp"
#include "goingrate/log/logbook.hpp"

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

struct Analysis;
struct FitOptions;
struct FitSummary;

/// What the log says of an entry.
enum class EntryVerdict : std::uint8_t {
  as_planned, ///< above zero by two sigma, and within two of what was planned
  differs,    ///< beyond three sigma of zero and of what was planned
  seen,       ///< seen; the entry names no size
  not_seen,   ///< within two sigma of zero, and not of what was planned
  unclear,    ///< neither
  outside, ///< the entry is from before or after the beats
};
std::string_view name_of(EntryVerdict verdict);

/// An entry, and what the log shows at its time.
struct EntryFinding {
  LogbookEntry entry;
  double at_s = 0.0; ///< after the first beat
  EntryVerdict verdict = EntryVerdict::not_seen;
  double found_at_s = std::numeric_limits<double>::quiet_NaN(); ///< of the change that goes with it
  /// In the unit of the entry's value, with its standard deviation; NaN where the log does not tell.
  double found = std::numeric_limits<double>::quiet_NaN();
  double found_sigma = std::numeric_limits<double>::quiet_NaN();
};

/// Something the log shows.
struct UnwrittenFinding {
  LogbookEntry entry;
  double at_s = 0.0; ///< after the first beat
};

/// A logbook beside a log.
struct LogbookCheck {
  std::string source;
  std::vector<EntryFinding> entries;   ///< in order of time
  std::vector<UnwrittenFinding> unwritten; ///< what the log shows and nobody wrote down
};

/// How far the times of an entry and of a change may be apart, s. Notes are made some minutes
/// before or after the work; one with a date alone may be of any time of that day.
inline constexpr double note_tolerance_s = 900.0;

/// Puts the entries of rate, weight and clean that lie within the beats into the found diary: a
/// change near the time of an entry gets the kind that was written down; where there is none, a
/// change begins where the entry says. Values with a sigma become what is known beforehand.
void take_entries(const Logbook& logbook, std::span<const Beat> beats, Diary& diary);

/// The ratio that parameter `name` has after event k (from 1) of a fit to what it was before, with
/// its standard deviation, in which the two go together as the fit says; nothing where the fit does
/// not determine both.
struct FoundRatio {
  double ratio = 1.0, sigma = 0.0;
};
std::optional<FoundRatio> ratio_at(const FitSummary& fit, std::string_view name, std::size_t k);

/// The options without what was planned where `alone`, a fit that does not know it, excludes it by
/// five sigma.
FitOptions without_what_is_excluded(FitOptions options, const FitSummary& alone);

/// Compares. A change of the rate is the difference of the mean rates up to the neighbouring
/// changes and entries, of drive and friction that of the parameters of `fit`, which must not know
/// what was planned. (LogbookCheckTest.PlannedAgainstFound)
LogbookCheck check_logbook(const Logbook& logbook, const Analysis& data, const FitSummary& fit);

/// All that the log shows, as a logbook in the log's own times: changes, stops, settings.
Logbook findings_of(const Analysis& data);

} // namespace goingrate

// What the keeper of a clock wrote down, compared with what its log shows.
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
  as_planned, ///< beyond two sigma of zero, and within two of what was planned
  differs,    ///< beyond three sigma of zero and of what was planned
  seen,       ///< seen; the entry names no size, or the log tells none
  not_seen,   ///< nothing like it in the log; a size within two sigma of zero, not of the plan
  unclear,    ///< none of these, or the log does not tell
  outside,    ///< the entry is from before or after the beats
};
std::string_view name_of(EntryVerdict verdict);

/// An entry, and what the log shows at its time.
struct EntryFinding {
  LogbookEntry entry;
  double at_s = 0.0; ///< after the first beat
  EntryVerdict verdict = EntryVerdict::not_seen;
  double found_at_s = std::numeric_limits<double>::quiet_NaN(); ///< s, of its match; NaN: none
  /// In the unit of the entry's value, with its standard deviation; NaN if the log does not tell.
  double found = std::numeric_limits<double>::quiet_NaN();
  double found_sigma = std::numeric_limits<double>::quiet_NaN();
};

/// Something the log shows and nobody wrote down.
struct UnwrittenFinding {
  LogbookEntry entry;
  double at_s = 0.0; ///< after the first beat
};

/// A logbook compared with a log.
struct LogbookCheck {
  std::string source;
  std::vector<EntryFinding> entries; ///< in order of time
  std::vector<UnwrittenFinding> unwritten;
};

/// How far the times of an entry and of a change may be apart, s. Notes are made some minutes
/// before or after the work; one with only a date may be of any time of that day.
inline constexpr double note_tolerance_s = 900.0;

/// Puts the entries `rate`, `weight` and `clean` that lie within the beats into `diary`, as it was
/// found: a change near the time of an entry gets the kind that was written down; where there is
/// none and the entry has a time of day, a change is added at that time. A value with a sigma
/// becomes a prior of the fit.
void take_entries(const Logbook& logbook, std::span<const Beat> beats, Diary& diary);

/// Parameter `name` after event k (from 1) of a fit over what it was before, with its standard
/// deviation, which takes the correlation of the two from the fit; nothing where the fit does not
/// determine both.
struct FoundRatio {
  double ratio = 1.0, sigma = 0.0;
};
std::optional<FoundRatio> ratio_at(const FitSummary& fit, std::string_view name, std::size_t k);

/// The options without those planned changes that `alone`, a fit that was not told them, excludes
/// by five sigma.
FitOptions without_what_is_excluded(FitOptions options, const FitSummary& alone);

/// Compares the entries with the log. A change of the rate is the difference of the mean rates on
/// either side, up to the next change or entry; a change of drive or friction is the ratio of the
/// parameters of `fit`, which must not have been told the plan.
/// (LogbookCheckTest.PlannedAgainstFound)
LogbookCheck check_logbook(const Logbook& logbook, const Analysis& data, const FitSummary& fit);

/// All that the log shows, as a logbook in the log's own times: changes, stops, settings.
Logbook findings_of(const Analysis& data);

} // namespace goingrate

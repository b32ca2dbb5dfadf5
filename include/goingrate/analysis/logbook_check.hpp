// Compares the logbook that a clock's keeper wrote with the clock's log.
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

/// The verdict of the log on an entry.
enum class EntryVerdict : std::uint8_t {
  as_planned, ///< more than two sigma from zero, and within two sigma of the plan
  differs,    ///< more than three sigma from zero and from the plan
  seen,       ///< found in the log; the entry gives no size, or the log does not
  not_seen,   ///< not found, or of a size within two sigma of zero but not of the plan
  unclear,    ///< none of these, or the log does not show it
  outside,    ///< the entry is from before or after the beats
};
std::string_view name_of(EntryVerdict verdict);

/// An entry, and the finding of the log at its time.
struct EntryFinding {
  LogbookEntry entry;
  double at_s = 0.0; ///< after the first beat
  EntryVerdict verdict = EntryVerdict::not_seen;
  double found_at_s = std::numeric_limits<double>::quiet_NaN(); ///< of the match; NaN: none
  /// In the unit of the entry's value, with its standard deviation; NaN if the log does not tell.
  double found = std::numeric_limits<double>::quiet_NaN();
  double found_sigma = std::numeric_limits<double>::quiet_NaN();
};

/// Something that the log shows and nobody wrote down.
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

/// The largest distance between the times of an entry and of a change, s, unless the log's readings
/// are farther apart. Notes are made some minutes before or after the work; an entry with only a
/// date may belong to any time of that day.
inline constexpr double note_tolerance_s = 900.0;

/// Merges the entries `rate`, `weight` and `clean` that lie within the beats into the `diary` that
/// was found from the log. A change near the time of an entry gets the kind that was written down.
/// If there is none and the entry has a time of day, a change is added at that time. A value with a
/// sigma becomes a prior of the fit.
void take_entries(const Logbook& logbook, std::span<const Beat> beats, Diary& diary);

/// The ratio of parameter `name` after event k (from 1) of a fit to its value before, with a
/// standard deviation that includes their correlation in the fit; nothing if the fit does not
/// determine both.
struct FoundRatio {
  double ratio = 1.0, sigma = 0.0;
};
std::optional<FoundRatio> ratio_at(const FitSummary& fit, std::string_view name, std::size_t k);

/// The options without the planned changes that are excluded by five sigma by `alone`, a fit that
/// did not use the plans.
FitOptions without_what_is_excluded(FitOptions options, const FitSummary& alone);

/// Compares the entries with the log. A change of the rate is the difference of the mean rates on
/// either side, up to the next change or entry; a change of drive or friction is the ratio of the
/// parameters of `fit`, which must not have used the plans.
/// (LogbookCheckTest.PlannedAgainstFound)
LogbookCheck check_logbook(const Logbook& logbook, const Analysis& data, const FitSummary& fit);

/// Everything that the log shows, as a logbook in the times of the log: changes, stops, and
/// settings of the hands.
Logbook findings_of(const Analysis& data);

} // namespace goingrate

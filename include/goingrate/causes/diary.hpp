// Dated changes of a clock's rate and amplitude, found in its log.
#pragma once

#include "goingrate/fit/fit_event.hpp"
#include "goingrate/fit/timing_data.hpp"
#include "goingrate/log/beats.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace goingrate {

/// What changed.
enum class ChangeKind {
  unclear,
  regulation, ///< a lasting change of the rate, the amplitude unchanged: length, or a weight
  drive,      ///< the rate jumps, and changes further as the amplitude settles
  friction,   ///< no jump: the rate changes with the amplitude
};
std::string_view name_of(ChangeKind kind);

/// A moment at which the rate or the speed of change of the amplitude jumped.
struct Change {
  std::int64_t cycle = 0;
  double at_s = 0.0; ///< after the first beat
  /// Rate excess after minus before. For a change of the regulation all beats up to the
  /// neighbouring changes are used. For the drive and friction it is the change at first, before
  /// the amplitude has settled (after it has settled for friction that add_small_changes() found),
  /// and sigma is NaN.
  double rate_change = 0.0, rate_change_sigma = 0.0;
  double amplitude_slope_change = 0.0; ///< rad/s after minus before; NaN without amplitudes
  /// In units of the log's typical fluctuation; the square root of `gain` where add_small_changes()
  /// found the change.
  double significance = 0.0;
  bool stands_out = true; ///< from neighbouring beats; false where add_small_changes() found it
  ChangeKind kind = ChangeKind::unclear;
  ChangeKind next_kind = ChangeKind::unclear; ///< second best explanation
  double gain = 0.0;      ///< in 2 log L over no change, less the price of the parameters
  double kind_gain = 0.0; ///< in 2 log L of `kind` over `next_kind`, less the prices
  /// Mean rate from the change before (or the first beat) to this one, and from this one to the
  /// next (or the last beat). NaN with fewer than three beats between; sigma is NaN with fewer than
  /// five.
  double rate_before = 0.0, rate_before_sigma = 0.0;
  double rate_after = 0.0, rate_after_sigma = 0.0;
  bool noted = false; ///< the keeper of the clock wrote it down, with its kind
  /// The change of the parameter that belongs to the kind, as planned, if the keeper noted it.
  std::optional<PlannedRatio> planned{};
  /// Whether it was written down but not found by the search.
  [[nodiscard]] bool is_only_noted() const { return noted && significance == 0.0; }
};

/// An exponential approach of the amplitude to a limit, A = limit + (start - limit) exp(-t/time).
struct Relaxation {
  double time_constant_s = 0.0;
  double sigma_s = 0.0;    ///< widened by the correlation of the residuals
  double window_s = 0.0;   ///< the stretch of log that was fitted
  double limit_rad = 0.0;  ///< 0 for a free decay
  double rms_rad = 0.0;    ///< of the residuals
  bool exponential = true; ///< false: the time depends on the stretch fitted (see below) by 4 sigma
  double shorter_window_s = 0.0; ///< time constant fitted to three quarters of the window,
  double longer_window_s = 0.0;  ///< and to five quarters of it; they show how far the result
                                 ///< depends on the window. NaN where that fit failed
};

/// A stretch with no drive or less of it: the rate jumps at its start and back at its end; the
/// amplitude decays in between and recovers afterwards.
struct Interruption {
  Change begin;
  Change end;
  double amplitude_before_rad = 0.0;
  double amplitude_after_rad = 0.0; ///< at its end
  double rate_change = 0.0;         ///< during it
  std::optional<Relaxation> decay;
  std::optional<Relaxation> recovery;
};

/// All changes found in a log.
struct Diary {
  std::vector<Change> changes; ///< in order of time
  std::vector<Interruption> interruptions;
};

/// Settings of the search.
struct DiaryOptions {
  std::size_t window = 30;              ///< beats on each side of a change
  double least_significance = 10.0;     ///< in units of the jump's robust scatter
  double least_rate_change = 1e-6;      ///< 0.09 s a day: smaller changes are not reported
  double least_amplitude_change = 1e-3; ///< of the amplitude, over one window
  std::size_t most_changes = 8;
  double recovery_window_s = 3000.0;
};

/// Looks for changes in a run of good beats.
///
/// The clock's error and the amplitude are locally straight lines; at each beat the slopes of the
/// `window` beats before and after are compared. The jump is a change where it exceeds
/// `least_significance` times its own robust scatter over the log, so that a clock's ordinary
/// wander raises no alarm. The date is refined by a least-squares broken line. The kind is the one
/// of the greatest likelihood: rate and amplitude between the neighbouring changes are fitted with
/// the course that each kind predicts, in noise that may wander (ChangeKindTest).
/// TrinityTest.FindsTheInterruption dates the known one; DiaryTest.QuietLogsStayQuiet bounds false
/// alarms.
Diary keep_diary(std::span<const Beat> beats, double nominal_period_s,
                 const DiaryOptions& options = {});

/// The same for few readings (are_few_readings()) of a clock: steps of the rate, by their likelihood
/// (src/causes/reading_changes.hpp; ReadingChangesTest). `data` are those of the beats, without
/// displacements.
Diary diary_of_readings(std::span<const Beat> beats, double nominal_period_s,
                        const TimingData& data);

/// Whether these are readings of a clock, and too few to be examined as beats are
/// (least_diagnosed_beats).
bool are_few_readings(const TimingData& data);

/// Two changes at the ends of a gap happened while no beats were logged, and become one change, dated
/// to its middle. (DiaryTest.AChangeWithinAGapIsOne)
void join_changes_across_gaps(std::span<const Beat> beats, Diary& diary);

/// The beats with the displacements of `data` removed, since these are not changes of the rate;
/// nullopt if there are none. (DiaryTest.ADisplacementIsNoRate)
std::optional<std::vector<Beat>> without_displacements(std::span<const Beat> beats,
                                                       const TimingData& data);

/// Recomputes the rates before and after each change; needed after dates were moved.
void put_rates(std::span<const Beat> beats, double nominal_period_s, Diary& diary);

/// The `most` most significant changes, of those that stand out or of the others, in order of time.
std::vector<Change> strongest_changes(const Diary& diary, std::size_t most, bool stand_out);

} // namespace goingrate

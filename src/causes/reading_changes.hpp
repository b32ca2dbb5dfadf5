// What happened to a clock that is read now and then. Private to the causes room and those above.
//
// A few dozen readings are too few for the blocks and spectra by which the beats of a pendulum are
// examined. With the time t in units of the log's length, their errors are
//   x = a + b t + sum_j c_j f_j(t) + noise,
//   cov(x, x') = s^2 (delta + u min(t, t') + v m^2 (3 M - m)/6),   m, M = min, max(t, t'):
// errors of reading, a random walk of the clock, and a random walk of its rate. f is max(0, t -
// t_j) where the rate steps, 1 from t_j on where the hands were set, and 1 at t_j alone for a
// reading that is wrong. s follows in closed form, u and v are those of the greatest likelihood, so
// that a rate that wanders is not taken for one that steps.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <span>
#include <vector>

namespace goingrate::timing_model {

/// A step of the rate, or of the times.
struct ReadingChange {
  double at_s = 0.0;      ///< after the first reading
  double size = 0.0;      ///< of the rate (relative), or of the times, s
  double gain = 0.0;      ///< in 2 log L over the other changes alone, less the price
  bool is_of_rate = true; ///< else the hands were set, or the reference was
};

/// The changes among readings at times (s, rising) that are late by `late_s`, in order of time.
///
/// They are taken one by one, or two where neither pays alone, as long as 2 log L rises by twice a
/// convincing gain (account.hpp), and by one more for each that is known, after a price of three
/// times log n: the date, which is searched for, counts as two numbers. The gain must also be half
/// of what a wander of the rate beside them gains. A step of the rate has at least six readings
/// on either side, one of the times two. A single wrong reading is left out of account. Cost:
/// O(n^3), some seconds for 400. ReadingChangesTest.FindsATurnOfTheNut,
/// ReadingChangesTest.FindsATurnAndItsReturn, ReadingChangesTest.FindsHandsThatWereSet,
/// ReadingChangesTest.QuietReadingsStayQuiet
std::vector<ReadingChange> changes_among_readings(std::span<const double> time_s,
                                                  std::span<const double> late_s);

/// The same of the readings of `data`, as they were read; `at_s` is after the first beat.
std::vector<ReadingChange> changes_among_readings(const TimingData& data);

/// Subtracts the steps of the times of few readings, and notes them in `displaced`.
void level_settings(TimingData& data);

} // namespace goingrate::timing_model

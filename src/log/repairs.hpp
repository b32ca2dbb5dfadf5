// Repairs to a log after all of it has been read.
#pragma once

#include "issue_list.hpp"

#include "goingrate/log/clock_log.hpp"

#include <span>

namespace goingrate {

/// Reverses the order of events and columns; data on a grid get new places.
void turn_round(ClockLog& log);

/// For readings of a clock's error at uneven times, such as some time each day, in any order: gives
/// those at evenly spaced times, by linear interpolation. Returns the step: the usual one of the
/// labels, `label_step_s`, or the week or day close to it; of several readings a day, as many as on
/// a day that has any (nights of up to 16 hours are bridged). `clock_errors_s` has the error at each
/// event. Labels that keep to the step, to within a second, are not changed
/// (ReadingTest.ErrorsReadAtUnevenTimes, ReadingTest.ErrorsReadSeveralTimesADay).
double level_labels(ClockLog& log, std::span<const double> clock_errors_s, double label_step_s,
                    IssueList& issues);

/// Moves events whose labels were written a step early or late by `label_step_s`. Such a label
/// gives two events at almost the same time next to a double step; several of them in a row lie
/// between the two.
void mend_label_jitter(ClockLog& log, double label_step_s, IssueList& issues);

/// Sorts events by time, with their columns; each event that came too late is an issue. If the time
/// goes back and continues from there, a new block begins, which is sorted by itself. Blocks of a
/// log whose times are `dated` are put in order too if they do not overlap.
void restore_order(ClockLog& log, bool dated, IssueList& issues);

} // namespace goingrate

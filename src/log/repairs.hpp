// What is put right in a log once all of it has been read.
#pragma once

#include "issue_list.hpp"

#include "goingrate/log/clock_log.hpp"

#include <span>

namespace goingrate {

/// Reverses the order of events and columns; data on a grid get new places.
void turn_round(ClockLog& log);

/// Readings of a clock's error that somebody took at uneven times, as at some time each day: each
/// is moved to the nearest of even times by the straight line to its neighbour there. Their step is
/// returned: the usual one of the labels, `label_step_s`, or the week, day or hour that it is near.
/// `clock_errors_s` are those of the events. Labels that keep to the step, but for whole seconds,
/// stay (ReadingTest.ErrorsReadAtUnevenTimes).
double level_labels(ClockLog& log, std::span<const double> clock_errors_s, double label_step_s);

/// A label that was written a step early or late gives two events at almost one time next to
/// a double step; if several in a row were, their steps stand between the two. These events are
/// moved by `label_step_s`.
void mend_label_jitter(ClockLog& log, double label_step_s, IssueList& issues);

/// Sorts events by time, with their columns; each one that came too late is an issue. Where the
/// time goes back and goes on from there a block begins, which is sorted by itself. Blocks of a log
/// whose times are `dated`, and that have no hours in common, are put in order too.
void restore_order(ClockLog& log, bool dated, IssueList& issues);

} // namespace goingrate

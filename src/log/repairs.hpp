// What is put right in a log once all of it has been read.
#pragma once

#include "issue_list.hpp"

#include "goingrate/log/clock_log.hpp"

namespace goingrate {

/// Reverses the order of events and columns; data on a grid get new places.
void turn_round(ClockLog& log);

/// A label that was written a step early or late gives two events at almost one time next to
/// a double step; if several in a row were, their steps stand between the two. These events are
/// moved by `label_step_s`.
void mend_label_jitter(ClockLog& log, double label_step_s, IssueList& issues);

/// Sorts events by time, with their columns; each one that came too late is an issue. Where the
/// time goes back and goes on from there a block begins, which is sorted by itself. Blocks of a log
/// whose times are `dated`, and that have no hours in common, are put in order too.
void restore_order(ClockLog& log, bool dated, IssueList& issues);

} // namespace goingrate

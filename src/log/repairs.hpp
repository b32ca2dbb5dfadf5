// What is put right in a log once all of it has been read.
#pragma once

#include "issue_list.hpp"

#include "goingrate/log/clock_log.hpp"

namespace goingrate {

/// Reverses the order of events and columns.
void turn_round(ClockLog& log);

/// A label that was written a step early or late gives two events at almost one time beside a
/// double step: the event is moved by `label_step_s`.
void mend_label_jitter(ClockLog& log, double label_step_s, IssueList& issues);

/// Sorts events by time, with their columns; each one that came too late is an issue.
void restore_order(ClockLog& log, IssueList& issues);

} // namespace goingrate

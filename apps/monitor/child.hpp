// Processes of a monitor.
#pragma once

namespace goingrate::apps {

/// Said in a child: it has neither the monitor's signals nor its files, not the lock, not the port,
/// but standard output, standard error and `kept`; it has nothing to read.
void stand_alone(int kept);

} // namespace goingrate::apps

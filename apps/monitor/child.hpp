// Child processes of a monitor.
#pragma once

namespace goingrate::apps {

/// To be called in a child process. It keeps neither the monitor's signals nor its files (the lock,
/// the port), only standard output, standard error and `kept`; its standard input is empty.
void stand_alone(int kept);

} // namespace goingrate::apps

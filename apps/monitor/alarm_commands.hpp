// The commands that are run when an alarm begins or ends.
#pragma once

#include "alarms.hpp"

#include <string>
#include <sys/types.h>
#include <vector>

namespace goingrate::apps {

/// Runs a shell command for every alarm, with empty input, and does not wait for it; after a minute
/// it is ended (AlarmCommandsTest).
class AlarmCommands {
public:
  explicit AlarmCommands(std::string command) : command_(std::move(command)) {}

  void run(const AlarmChange& change);
  /// The failures, in words, of the commands that have ended since the last call.
  std::vector<std::string> take_failures();

private:
  struct Running {
    pid_t process = 0;
    std::string alarm;
  };

  std::string command_; // empty: nothing is run
  std::vector<Running> running_;
};

} // namespace goingrate::apps

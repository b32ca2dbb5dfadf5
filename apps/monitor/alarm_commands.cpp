#include "alarm_commands.hpp"

#include "child.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

namespace goingrate::apps {

namespace {

std::string outcome_of(int status) {
  constexpr int timeout_ended_it = 124; // the exit status of timeout(1) then
  if (WIFSIGNALED(status)) return fmt::format("was ended by signal {}", WTERMSIG(status));
  if (WEXITSTATUS(status) == timeout_ended_it) return "took more than a minute";
  return fmt::format("failed with code {}", WEXITSTATUS(status));
}

} // namespace

void AlarmCommands::run(const AlarmChange& change) {
  if (command_.empty()) return;
  const std::string alarm(name_of(change.kind));
  const pid_t child = ::fork();
  if (child != 0) {
    running_.push_back({child, alarm});
    return;
  }
  ::setenv("GOINGRATE_ALARM", alarm.c_str(), 1);
  ::setenv("GOINGRATE_STATE", change.is_raised ? "raised" : "cleared", 1);
  ::setenv("GOINGRATE_TEXT", change.text.c_str(), 1);
  stand_alone(STDERR_FILENO);
  ::execlp("timeout", "timeout", "-k", "5", "60", "/bin/sh", "-c", command_.c_str(), nullptr);
  ::execl("/bin/sh", "sh", "-c", command_.c_str(), nullptr); // if timeout(1) is missing
  std::_Exit(127);
}

std::vector<std::string> AlarmCommands::take_failures() {
  std::vector<std::string> failures;
  std::erase_if(running_, [&](const Running& running) {
    int status = 0;
    const pid_t ended = running.process < 0 ? -1 : ::waitpid(running.process, &status, WNOHANG);
    if (ended == 0) return false;
    if (running.process < 0)
      failures.push_back(fmt::format("the command of alarm {} could not be run", running.alarm));
    else if (ended > 0 && status != 0)
      failures.push_back(
          fmt::format("the command of alarm {} {}", running.alarm, outcome_of(status)));
    return true;
  });
  return failures;
}

} // namespace goingrate::apps

#include "child.hpp"

#include <algorithm>
#include <csignal>
#include <fcntl.h>
#include <unistd.h>

namespace goingrate::apps {

void stand_alone(int kept) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE})
    std::signal(number, SIG_DFL);
  ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
  constexpr int first_own = 3;
  if (kept > first_own) ::close_range(first_own, static_cast<unsigned>(kept) - 1, 0);
  ::close_range(static_cast<unsigned>(std::max(kept + 1, first_own)), ~0U, 0);
}

} // namespace goingrate::apps

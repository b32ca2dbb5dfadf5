// Processor time, to measure methods on a machine with other load.
#pragma once

#include <chrono>
#include <ctime>

namespace goingrate {

/// The time that the calling thread has spent on a processor; other threads and programs do not
/// count.
struct ThreadClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ThreadClock>;
  static constexpr bool is_steady = true;

  static time_point now() noexcept {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return time_point(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
  }
};

/// Seconds of this thread that `work` takes.
template <class Work> double thread_seconds(Work&& work) {
  const auto begin = ThreadClock::now();
  work();
  return std::chrono::duration<double>(ThreadClock::now() - begin).count();
}

} // namespace goingrate

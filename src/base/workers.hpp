// Shares work among threads: as many as can be started, at least the caller's own.
#pragma once

#include "goingrate/base/pulse.hpp"

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>

namespace goingrate {

/// A thread that does `work`; if none can be started, one that is not joinable and does nothing.
std::thread thread_if_possible(std::function<void()> work);

/// `wanted` threads, or one per processor if that is 0.
std::size_t threads_or_usual(std::size_t wanted);

/// Calls `work` from `threads` threads at a time, the caller's among them, and returns when all are
/// done. There are fewer threads if a limit on threads or memory does not allow more. Work that is
/// shared again inside `work` runs in its one thread. The first exception of any thread is thrown
/// here, after `give_up`.
void run_together(std::size_t threads, const std::function<void()>& work,
                  const std::function<void()>& give_up);

/// Calls worker(i) for each i below `count`, each in one of up to `threads` threads; every thread
/// makes its own worker. After an exception no further i is begun.
template <class MakeWorker>
void share_out(std::size_t count, std::size_t threads, MakeWorker make_worker) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    auto worker = make_worker();
    for (std::size_t i = next++; i < count; i = next++) {
      pulse();
      worker(i);
    }
  };
  run_together(threads < count ? threads : count, work, [&] { next = count; });
}

/// The same for work that needs nothing of its own in each thread.
template <class Work> void share(std::size_t count, std::size_t threads, const Work& work) {
  share_out(count, threads, [&] { return [&](std::size_t i) { work(i); }; });
}

/// The same with one thread per processor.
template <class Work> void share(std::size_t count, const Work& work) {
  share(count, threads_or_usual(0), work);
}

} // namespace goingrate

#include "base/workers.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <system_error>
#include <utility>
#include <vector>

namespace goingrate {

namespace {

thread_local bool is_part_of_shared_work = false;

// While it lives, the work of this thread is not shared among further threads.
class Part {
public:
  Part() : was_(std::exchange(is_part_of_shared_work, true)) {}
  ~Part() { is_part_of_shared_work = was_; }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

private:
  bool was_;
};

// If memory is limited, the stacks of many threads would leave none for their work. For each thread
// this much is set aside until all have started; it is more than a thread needs.
constexpr std::size_t room_a_thread = std::size_t{8} << 20;
using Room = std::unique_ptr<char[]>;
Room put_aside() { return Room(new (std::nothrow) char[room_a_thread]); }

// The threads other than the caller's; they wait until all are started.
class Others {
public:
  Others(std::size_t count, const std::function<void()>& run) {
    std::vector<Room> rooms;
    threads_.reserve(count);
    rooms.reserve(count + 1);
    rooms.push_back(put_aside()); // the caller's
    while (threads_.size() < count && rooms.back()) {
      rooms.push_back(put_aside());
      if (!rooms.back()) break;
      std::thread thread = thread_if_possible([&] {
        all_are_started_.wait(false);
        run();
      });
      if (!thread.joinable()) break;
      threads_.push_back(std::move(thread));
    }
    rooms.clear();
    all_are_started_ = true;
    all_are_started_.notify_all();
  }
  Others(const Others&) = delete;
  Others& operator=(const Others&) = delete;
  ~Others() {
    for (std::thread& thread : threads_)
      thread.join();
  }

private:
  std::atomic<bool> all_are_started_{false};
  std::vector<std::thread> threads_;
};

} // namespace

std::thread thread_if_possible(std::function<void()> work) {
  try {
    return std::thread(std::move(work));
  } catch (const std::system_error&) { // no more threads, or no room for a stack
  } catch (const std::bad_alloc&) {
  }
  return {};
}

std::size_t threads_or_usual(std::size_t wanted) {
  return wanted > 0 ? wanted : std::max(1U, std::thread::hardware_concurrency());
}

void run_together(std::size_t threads, const std::function<void()>& work,
                  const std::function<void()>& give_up) {
  if (threads <= 1 || is_part_of_shared_work) {
    const Part part; // so that the work itself starts no further threads
    work();
    return;
  }
  std::exception_ptr failure;
  std::mutex failing;
  const std::function<void()> run = [&] {
    try {
      const Part part;
      work();
    } catch (...) {
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
      give_up();
    }
  };
  {
    const Others others(threads - 1, run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

} // namespace goingrate

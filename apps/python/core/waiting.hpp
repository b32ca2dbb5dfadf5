// What Python may do while the library works.
#pragma once

#include "goingrate/base/pulse.hpp"

#include <chrono>
#include <pybind11/pybind11.h>
#include <string_view>
#include <utility>

namespace goingrate::python {

/// While it lives, other threads of Python run, Ctrl-C ends the library's work with
/// KeyboardInterrupt, and `progress` (a callable or None) is told how far it is; what that raises
/// ends the work too.
class Waiting {
public:
  explicit Waiting(pybind11::object progress)
      : progress_(std::move(progress)), scope_([this] { look_for_signals(); }) {}

  /// The share done (0 to 1), or what is being done.
  template <class News> void tell(const News& news) {
    if (progress_.is_none()) return look_for_signals();
    const pybind11::gil_scoped_acquire held;
    raise_if_interrupted();
    progress_(news);
  }
  [[nodiscard]] bool is_asked() const { return !progress_.is_none(); }

private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds often{50}; // nobody notices such a delay

  static void raise_if_interrupted() {
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
  }
  void look_for_signals() {
    const Clock::time_point now = Clock::now();
    if (now - last_ < often) return;
    last_ = now;
    const pybind11::gil_scoped_acquire held;
    raise_if_interrupted();
  }

  pybind11::object progress_; // let go of after `released_` has taken the lock again
  Clock::time_point last_ = Clock::now();
  PulseScope scope_;
  pybind11::gil_scoped_release released_;
};

} // namespace goingrate::python

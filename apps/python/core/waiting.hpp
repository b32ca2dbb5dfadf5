// Keeps Python responsive (threads, Ctrl-C, progress callbacks) while the library works.
#pragma once

#include "goingrate/base/pulse.hpp"

#include <chrono>
#include <pybind11/pybind11.h>
#include <string_view>
#include <utility>

namespace goingrate::python {

/// A scope for a long call into the library. It releases the GIL so that other Python threads can
/// run, makes Ctrl-C end the work with KeyboardInterrupt, and passes progress on to `progress` (a
/// callable or None). An exception that the callable raises ends the work too.
class Waiting {
public:
  explicit Waiting(pybind11::object progress)
      : progress_(std::move(progress)), scope_([this] { look_for_signals(); }) {}

  /// Calls `progress` with `news`: the share of the work done (0 to 1), or the name of the current
  /// step.
  template <class News> void tell(const News& news) {
    if (progress_.is_none()) return look_for_signals();
    const pybind11::gil_scoped_acquire held;
    raise_if_interrupted();
    progress_(news);
  }
  [[nodiscard]] bool is_asked() const { return !progress_.is_none(); }

private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds signal_check_interval{50}; // too short to notice

  static void raise_if_interrupted() {
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
  }
  void look_for_signals() {
    const Clock::time_point now = Clock::now();
    if (now - last_ < signal_check_interval) return;
    last_ = now;
    const pybind11::gil_scoped_acquire held;
    raise_if_interrupted();
  }

  // Dropping a reference needs the GIL, so progress_ must be destroyed after released_, which
  // reacquires it: keep progress_ above released_.
  pybind11::object progress_;
  Clock::time_point last_ = Clock::now();
  PulseScope scope_;
  pybind11::gil_scoped_release released_;
};

} // namespace goingrate::python

// A bar on the terminal for work that lasts.
#pragma once

#include <chrono>

namespace goingrate::apps {

/// Draws itself on standard error while that is a terminal, from the second second on, and wipes
/// itself out at the end.
class ProgressBar {
public:
  explicit ProgressBar(bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `part` of the work is done, 0 to 1.
  void operator()(double part);

private:
  using Clock = std::chrono::steady_clock;
  bool wanted_;
  bool drawn_ = false;
  Clock::time_point start_, last_;
};

} // namespace goingrate::apps

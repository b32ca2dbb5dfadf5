// What a terminal shows while work lasts.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace goingrate::apps {

/// Says what is being done, how much of it is done, and how long the rest may take:
/// "reading my.log [####......] 42 %, 0:01:23 left", on standard error while that is a terminal,
/// from the second second on; wipes itself out at the end.
class ProgressBar {
public:
  ProgressBar(bool quiet, std::string_view what);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `part` of the work is done, 0 to 1.
  void operator()(double part);

private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool wanted_;
  bool drawn_ = false;
  Clock::time_point start_, last_;
};

/// Says what is being done where nobody knows how much of it is left: "fitting the model ... 12 s",
/// on standard error while that is a terminal, from the second second on; wipes itself out at the
/// end. No note may be written while it lives.
class StepLine {
public:
  StepLine(bool quiet, std::string_view what);
  ~StepLine();
  StepLine(const StepLine&) = delete;
  StepLine& operator=(const StepLine&) = delete;

  /// This is done from now on.
  void operator()(std::string_view what);

private:
  void draw_until_ended();
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string what_;
  bool ended_ = false;
  std::thread drawing_; // not running if nobody looks, or if no thread can be started
};

} // namespace goingrate::apps

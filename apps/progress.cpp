#include "progress.hpp"

#include "base/printable.hpp"
#include "base/workers.hpp"
#include "terminal.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fmt/format.h>

namespace goingrate::apps {

namespace {

using namespace std::chrono_literals;
constexpr auto patience = 1s; // work that is done before then needs no word

bool somebody_looks(bool quiet) { return !quiet && error_is_terminal(); }

// Time left if the rest goes as before: ", 1:23:20 left"; nothing until a hundredth is done.
std::string time_left(double passed_s, double part) {
  if (part < 0.01) return {};
  const auto left = static_cast<std::int64_t>(std::ceil(passed_s * (1.0 - part) / part));
  return fmt::format(", {}:{:02}:{:02} left ", left / 3600, left / 60 % 60, left % 60);
}

constexpr const char* wipe = "\r\x1b[K"; // back to the first column, rest of the line empty

} // namespace

ProgressBar::ProgressBar(bool quiet, std::string_view what)
    : what_(printable(what)), wanted_(somebody_looks(quiet)), start_(Clock::now()), last_(start_) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs(wipe, stderr);
}

void ProgressBar::operator()(double part) {
  if (!wanted_) return;
  const auto now = Clock::now();
  if (now - start_ < patience || now - last_ < 100ms) return;
  last_ = now;
  drawn_ = true;
  constexpr int width = 30; // columns, so that a file's name has room before it
  const int full = static_cast<int>(part * width);
  std::fputs(fmt::format("{}{} [{:#<{}}{:.<{}}] {:3.0f} %{}", wipe, what_, "", full, "",
                         width - full, 100.0 * part,
                         time_left(std::chrono::duration<double>(now - start_).count(), part))
                 .c_str(),
             stderr);
  std::fflush(stderr);
}

StepLine::StepLine(bool quiet, std::string_view what) : what_(what) {
  if (somebody_looks(quiet)) drawing_ = thread_if_possible([this] { draw_until_ended(); });
}

StepLine::~StepLine() {
  if (!drawing_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_one();
  drawing_.join();
}

void StepLine::operator()(std::string_view what) {
  const std::lock_guard lock(mutex_);
  what_ = what;
}

void StepLine::draw_until_ended() {
  std::unique_lock lock(mutex_);
  int seconds = 0;
  while (!changed_.wait_for(lock, patience, [this] { return ended_; })) {
    ++seconds;
    std::fputs(fmt::format("{}{} ... {} s", wipe, what_, seconds).c_str(), stderr);
    std::fflush(stderr);
  }
  if (seconds > 0) std::fputs(wipe, stderr);
}

} // namespace goingrate::apps

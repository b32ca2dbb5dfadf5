#include "progress.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace goingrate::apps {

ProgressBar::ProgressBar(bool quiet)
    : wanted_(!quiet && ::isatty(STDERR_FILENO) != 0), start_(Clock::now()), last_(start_) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\x1b[K", stderr); // back to the first column, rest of the line empty
}

void ProgressBar::operator()(double part) {
  using namespace std::chrono_literals;
  if (!wanted_) return;
  const auto now = Clock::now();
  if (now - start_ < 1s || now - last_ < 100ms) return;
  last_ = now;
  drawn_ = true;
  constexpr int width = 40;
  const int full = static_cast<int>(part * width);
  std::fputs(
      fmt::format("\r[{:#<{}}{:.<{}}] {:3.0f} %", "", full, "", width - full, 100.0 * part).c_str(),
      stderr);
  std::fflush(stderr);
}

} // namespace goingrate::apps

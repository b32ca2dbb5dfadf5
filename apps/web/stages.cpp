// Progress in a page, in place of apps/progress.cpp: the step under way is passed to the page that started the
// command, by `onStage(words, share)` of its module; the share is negative if it is not known how much is left.
#include "progress.hpp"

#include <emscripten.h>

EM_JS(void, tell_stage, (const char* words, double share), {
  if (Module["onStage"]) Module["onStage"](UTF8ToString(words), share);
});

namespace goingrate::apps {

namespace {
using namespace std::chrono_literals;
constexpr auto pause_between = 100ms;
constexpr double unknown_share = -1.0;
} // namespace

ProgressBar::ProgressBar(bool quiet, std::string_view what)
    : what_(what), wanted_(!quiet), start_(Clock::now()), last_(start_) {
  if (wanted_) tell_stage(what_.c_str(), 0.0);
}

ProgressBar::~ProgressBar() = default;

void ProgressBar::operator()(double part) {
  const auto now = Clock::now();
  if (!wanted_ || now - last_ < pause_between) return;
  last_ = now;
  tell_stage(what_.c_str(), part);
}

StepLine::StepLine(bool quiet, std::string_view what) : ended_(quiet) { (*this)(what); }

StepLine::~StepLine() = default;

void StepLine::operator()(std::string_view what) {
  what_ = what;
  if (!ended_) tell_stage(what_.c_str(), unknown_share);
}

} // namespace goingrate::apps

#include "goingrate/base/pulse.hpp"

#include <utility>

namespace goingrate {

namespace {
thread_local const std::function<void()>* current = nullptr;
} // namespace

PulseScope::PulseScope(std::function<void()> beat)
    : beat_(std::move(beat)), outer_(std::exchange(current, &beat_)) {}

PulseScope::~PulseScope() { current = outer_; }

void pulse() {
  if (current != nullptr && *current) (*current)();
}

} // namespace goingrate

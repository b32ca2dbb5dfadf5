// A way out of work that takes long: whoever asks for it leaves a function that is called now and
// then while the work goes on, and that may throw to end it.
#pragma once

#include <functional>

namespace goingrate {

/// While it lives, pulse() calls `beat` in the thread that made it, and in no other. Scopes nest:
/// the innermost counts.
class PulseScope {
public:
  explicit PulseScope(std::function<void()> beat); ///< until the end of the scope
  ~PulseScope();
  PulseScope(const PulseScope&) = delete;
  PulseScope& operator=(const PulseScope&) = delete;

private:
  std::function<void()> beat_;
  const std::function<void()>* outer_;
};

/// Called by the library between the pieces of what takes long: a search's steps, the items of
/// shared work. What the function of the scope throws ends that work and reaches its caller
/// (PulseTest.EndsAFit, PulseTest.EndsSharedWork). Costs 1 ns without a scope.
void pulse();

} // namespace goingrate

// Interrupts long work: a caller installs a function, which the library calls from time to time
// during the work, and which may throw to end it.
#pragma once

#include <functional>

namespace goingrate {

/// During its lifetime, pulse() calls `beat` in the thread that made it, and in no other. Scopes
/// nest: only the innermost function is called.
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

/// Called by the library between the pieces of long work: the steps of a search, the items of
/// shared work. An exception of the scope's function ends that work and reaches its caller
/// (PulseTest.EndsAFit, PulseTest.EndsSharedWork). Costs 1 ns without a scope.
void pulse();

} // namespace goingrate

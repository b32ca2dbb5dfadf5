// Counters that overflow, timers that roll over, times of day.
#pragma once

#include "goingrate/base/instant.hpp"

#include <optional>
#include <vector>

namespace goingrate {

/// Gives times that begin again from nothing their place in one run.
class Unwrapper {
public:
  struct Settings {
    std::optional<double> wrap_s{}; ///< known; 0: never; nothing: guessed at the first step back
    std::vector<double> candidates_s{}; ///< to guess from, ascending
    std::optional<double> step_s{};     ///< the expected step, for what wraps more than once a step
    TimeUnit unit{};                    ///< in which the wrap is a whole number
  };
  explicit Unwrapper(Settings settings) : settings_(std::move(settings)) {}

  Instant operator()(const Instant& raw);

  [[nodiscard]] std::int64_t wraps() const { return wraps_; }
  [[nodiscard]] double wrap_s() const { return settings_.wrap_s.value_or(0.0); }

private:
  void guess(double before_s, double after_s);
  void count_wraps(double step_s);

  Settings settings_;
  std::optional<Instant> last_raw_;
  double typical_step_s_ = 0.0; // running mean of the steps forward
  Instant offset_{};
  std::int64_t wraps_ = 0;
};

} // namespace goingrate

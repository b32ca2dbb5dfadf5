// Counters that overflow, timers that roll over, times of day.
#pragma once

#include "goingrate/log/layout.hpp"

#include <optional>
#include <vector>

namespace goingrate {

/// As the comparison of Instants, which also answers for NaN and is slower.
inline bool is_before(const Instant& a, const Instant& b) {
  return a.seconds < b.seconds || (a.seconds == b.seconds && a.fraction < b.fraction);
}

/// Turns times that start again from zero into one continuous run.
class Unwrapper {
public:
  struct Settings {
    std::optional<double> wrap_s{}; ///< known; 0: never; nothing: guessed at the first step back
    std::vector<double> candidates_s{}; ///< to guess from, ascending
    std::optional<double> step_s{};     ///< the expected step, for what wraps more than once a step
    TimeUnit unit{};                    ///< in which the wrap is a whole number
  };
  explicit Unwrapper(Settings settings) : settings_(std::move(settings)) {}

  /// `typical_step_s()`: of the steps before, to know a wrap from a jump; seldom asked.
  template <class TypicalStep> Instant operator()(const Instant& raw, TypicalStep typical_step_s) {
    if (!last_raw_) first_s_ = raw.to_double();
    const bool plain = wraps_ == 0 && !settings_.step_s && (!last_raw_ || !is_before(raw, *last_raw_));
    if (!plain) {
      const Instant same{raw.seconds, raw.fraction}; // so that `raw` may stay in registers
      return placed(same, typical_step_s());
    }
    last_raw_ = raw;
    return raw;
  }

  [[nodiscard]] std::int64_t wraps() const { return wraps_; }
  [[nodiscard]] double wrap_s() const { return settings_.wrap_s.value_or(0.0); }

private:
  Instant placed(const Instant& raw, double typical_step_s);
  void guess(double before_s, double after_s, double typical_step_s);
  void count_wraps(double step_s);
  [[nodiscard]] std::int64_t wraps_for_beats(double step_s) const;

  Settings settings_;
  std::optional<Instant> last_raw_;
  double first_s_ = 0.0;
  Instant offset_{};
  std::int64_t wraps_ = 0;
};

/// The settings that follow from the layout and, if known, the period.
Unwrapper::Settings unwrapping(const Layout& layout, std::optional<double> nominal_period_s);

} // namespace goingrate

// The answers of a monitor to requests.
#pragma once

#include "clock_watch.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace goingrate::apps {

/// The answers of a monitor at one moment.
struct WatchAnswers {
  std::string now, minutes, hours, days, alarms, breaks; ///< JSON
  std::string metrics;                                   ///< for Prometheus
};

/// Makes the answers. Rates are in s/day, amplitudes in rad, times in seconds since 1970; an
/// unknown value is null.
class WatchAnswering {
public:
  /// `name`: of the clock.
  explicit WatchAnswering(std::string name) : name_(std::move(name)) {}
  /// The answers at `now`. Minutes, hours and days, which are long for a clock watched for years,
  /// are made again with each new minute, or when they are a minute old.
  const WatchAnswers& at(const Instant& now, const ClockWatch& watch);

private:
  [[nodiscard]] bool blocks_are_old(const Instant& now, const Going& going) const;

  std::string name_;
  WatchAnswers answers_;
  std::optional<Instant> blocks_made_;
  std::int64_t last_minute_ = 0; // in the blocks
};

} // namespace goingrate::apps

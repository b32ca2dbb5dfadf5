// Numbers for beats as they come.
#pragma once

#include "common.hpp"

#include "goingrate/report/tables.hpp"

#include <optional>
#include <string>
#include <vector>

namespace goingrate::apps {

/// Numbers new events together with the last few hundred, so that what is printed is what a run
/// over the whole log would say. What was printed is never said otherwise: cycles go on from it.
class RollingNumbers {
public:
  explicit RollingNumbers(const LogOptions& options) : options_(options) {}

  void add(const Beat& event);
  /// From now on times have nothing to do with those before: a segment of its own, whose cycles go
  /// on.
  void begin_anew();
  /// Whether there is so much that it is worth numbering.
  [[nodiscard]] bool is_full() const;
  /// The rows of the events that were added; none until there are enough to be numbered.
  std::string rows(const ClockLog& log);
  /// What was held back, at the end of a short log.
  std::string rest(const ClockLog& log);

  [[nodiscard]] double period_s() const { return period_s_; } ///< 0 until it is known

private:
  // The way from cycles and segments of a numbering to those that are printed.
  struct Shift {
    std::int64_t cycles = 0;
    int segments = 0;
  };
  std::string numbered_rows(const ClockLog& log);
  [[nodiscard]] Shift shift_of(const std::vector<Beat>& numbered) const;
  void open_table(const ClockLog& log, const Beats& numbered, std::string& text);
  void print(Beat beat, std::string& text);
  void forget_old();

  const LogOptions& options_;
  std::vector<Beat> window_; // those that were printed are as they were printed
  std::size_t printed_ = 0;  // of the window
  std::optional<RateTable> table_;
  EventColumns no_columns_;
  std::vector<Gap> no_gaps_;
  std::optional<Beat> last_; // the last good one that was printed
  double period_s_ = 0.0;
};

} // namespace goingrate::apps

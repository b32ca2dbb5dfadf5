// Collects the faults found in the lines of a log.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <string>
#include <string_view>

namespace goingrate {

/// The two halves of a fault stated as "found X, expected Y"; for other faults `found` has all.
struct FaultWords {
  std::string_view found, expected;
};
FaultWords words_of(std::string_view fault);

/// Appends faults to `log.issues`. Consecutive lines with the same fault share one issue; so do
/// scattered ones once the list has grown long (see LineIssue). If `strict`, the first fault throws
/// InputError instead.
class IssueList {
public:
  IssueList(ClockLog& log, bool strict) : log_(log), strict_(strict) {}
  /// `found` says what is wrong, `action` what was done about it.
  void add(std::size_t line, std::size_t column, IssueKind kind, std::string found,
           std::string action);

private:
  [[noreturn]] void refuse(std::size_t line, std::size_t column, std::string_view found,
                           std::string_view action) const;

  ClockLog& log_;
  bool strict_;
};

} // namespace goingrate

// The list of what was wrong with a log's lines.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <string>

namespace goingrate {

/// Appends to `log.issues`, joining runs of lines with the same fault; throws InputError instead if
/// the reading is strict.
class IssueList {
public:
  IssueList(ClockLog& log, bool strict) : log_(log), strict_(strict) {}
  void add(std::size_t line, std::size_t column, IssueKind kind, std::string found,
           std::string action);

private:
  [[noreturn]] void refuse(std::size_t line, std::size_t column, std::string_view found,
                           std::string_view action) const;

  ClockLog& log_;
  bool strict_;
};

} // namespace goingrate

#include "issue_list.hpp"

#include "goingrate/base/errors.hpp"

#include <fmt/format.h>

namespace goingrate {

void IssueList::add(std::size_t line, std::size_t column, IssueKind kind, std::string found,
                    std::string action) {
  if (strict_)
    throw InputError({log_.source, line, column}, found,
                     fmt::format("a log without faults (--strict; otherwise: {})", action));
  if (!log_.issues.empty()) {
    LineIssue& last = log_.issues.back();
    if (last.kind == kind && last.column == column && last.last_line + 1 == line &&
        last.action == action) {
      last.last_line = line;
      return;
    }
  }
  log_.issues.push_back({line, column, kind, std::move(found), std::move(action), line});
}

std::string_view name_of(IssueKind kind) {
  switch (kind) {
  case IssueKind::unreadable:
    return "unreadable";
  case IssueKind::missing:
    return "missing";
  case IssueKind::no_value:
    return "no value";
  case IssueKind::out_of_range:
    return "out of range";
  case IssueKind::binary:
    return "binary";
  case IssueKind::truncated:
    return "truncated";
  case IssueKind::out_of_order:
    return "out of order";
  case IssueKind::label_jitter:
    return "label jitter";
  case IssueKind::gap:
    return "gap";
  case IssueKind::header:
    return "header";
  case IssueKind::incomplete:
    break;
  }
  return "incomplete";
}

} // namespace goingrate
